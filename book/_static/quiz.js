// Questions one at a time, each behind its number, with an answer to choose and to check. Which of
// them were answered right is kept in this browser, and nowhere else.
(() => {
  const KEY = `quiz:${new URL("..", document.currentScript.src).pathname}`; // this book's
  const forms = [...document.querySelectorAll("form.quiz")];
  if (!forms.length) return;
  const make = (tag, set = {}, ...inside) => {
    const made = Object.assign(document.createElement(tag), set);
    made.append(...inside);
    return made;
  };

  // A page opened from a folder, or with cookies off, may have no storage: then the page remembers.
  let right = new Set();
  const read = () => {
    try {
      right = new Set(JSON.parse(localStorage.getItem(KEY)));
    } catch (error) {
      if (error instanceof SyntaxError || error instanceof TypeError) right = new Set(); // not ours
    }
  };
  const keep = (change) => {
    read();
    change(right);
    try {
      localStorage.setItem(KEY, JSON.stringify([...right]));
    } catch {
      // it is not kept
    }
  };
  read();

  const told = make("p", { className: "quiz-told" });
  told.setAttribute("role", "status");
  const count = (first = "") => {
    const done = forms.filter((form) => right.has(form.id)).length;
    told.textContent = `${first}${done} of ${forms.length} right`;
    numbers.forEach((button, k) => {
      const known = right.has(forms[k].id);
      button.classList.toggle("done", known);
      button.setAttribute("aria-label", `Question ${k + 1}${known ? ", answered right" : ""}`);
    });
  };

  const questions = forms.map((form) => {
    const whys = [...form.querySelectorAll(".why")];
    const choices = [...form.querySelectorAll("label.choice")].map((label, k) => {
      const input = make("input", { type: "radio", name: form.id, value: k });
      label.prepend(input);
      return input;
    });
    const missing = make("div", { className: "missing", textContent: "Choose an answer first." });
    form.querySelector(".whys").append(missing);
    form.querySelector(".whys").setAttribute("aria-live", "polite");
    form.querySelector("details").replaceWith(form.querySelector(".whys")); // a line at a time
    const bar = make("div", { className: "quiz-bar" }, make("button", { textContent: "Check" }));
    form.querySelector("fieldset").append(bar);
    const tell = (shown) => {
      for (const line of [...whys, missing]) line.hidden = line !== shown;
    };
    const begin = () => {
      const known = right.has(form.id);
      choices.forEach((input, k) => {
        input.checked = known && whys[k].classList.contains("right");
      });
      tell(known && whys.find((why) => why.classList.contains("right")));
    };
    form.addEventListener("change", () => tell(null));
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const why = whys[choices.findIndex((input) => input.checked)] ?? missing;
      tell(why);
      if (!why.classList.contains("right")) return;
      keep((kept) => kept.add(form.id));
      count();
    });
    begin();
    return begin;
  });

  const numbers = forms.map((form, k) => make("button", { type: "button", textContent: `Question ${k + 1}` }));
  const show = (at) => {
    forms.forEach((form, k) => {
      form.hidden = k !== at;
      numbers[k].setAttribute("aria-expanded", String(k === at));
      numbers[k].setAttribute("aria-controls", form.id);
    });
    forms[at]?.querySelector(".quiz-bar").append(told, erase);
  };
  numbers.forEach((button, k) =>
    button.addEventListener("click", () => show(forms[k].hidden ? k : -1)),
  );
  const erase = make("button", { type: "button", textContent: "Erase my answers" });
  erase.addEventListener("click", () => {
    keep((kept) => forms.forEach((form) => kept.delete(form.id)));
    again("Erased. ");
  });
  const again = (first) => {
    for (const begin of questions) begin();
    count(first);
  };
  addEventListener("storage", ({ key }) => {
    if (key !== KEY) return; // another tab, or all work was erased
    read();
    again();
  });
  const group = make("div", { className: "quiz-numbers" }, ...numbers);
  group.setAttribute("role", "group");
  group.setAttribute("aria-label", "Questions");
  forms[0].before(group);
  document.documentElement.dataset.quiz = "";
  const linked = () => {
    const at = forms.findIndex((form) => `#${form.id}` === location.hash);
    show(at);
    forms[at]?.scrollIntoView();
  };
  addEventListener("hashchange", () => location.hash.startsWith("#quiz-") && linked());
  linked();
  count();
})();
