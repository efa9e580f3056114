// The same questions twice, before a course and after it. Answers are kept in this browser and
// nowhere else, and leave it in a file. What is right is shown after the second time.
(() => {
  const KEY = `quiz-twice:${new URL("..", document.currentScript.src).pathname}`; // this book's
  const TIMES = { before: "Before the course", after: "After the course" };
  const NAME = /^[\p{L}\p{N}_][\p{L}\p{N}_.@-]*$/u; // as in a list of students
  const box = document.querySelector(".twice");
  const make = (tag, set = {}, ...inside) => {
    const made = Object.assign(document.createElement(tag), set);
    made.append(...inside);
    return made;
  };
  const button = (textContent, act) => {
    const made = make("button", { type: "button", textContent });
    made.addEventListener("click", act);
    return made;
  };

  // Of each time: when it began and ended, and the letter chosen for each question.
  let kept = {};
  let remembers = true; // a page opened from a folder, or with cookies off, may have no storage
  const read = () => {
    try {
      kept = JSON.parse(localStorage.getItem(KEY)) ?? {};
    } catch (error) {
      if (error instanceof SyntaxError) kept = {}; // not ours
      else remembers = false;
    }
  };
  const keep = () => {
    try {
      localStorage.setItem(KEY, JSON.stringify(kept));
    } catch {
      remembers = false;
    }
  };
  const now = () => `${new Date().toISOString().slice(0, 19)}Z`;
  const taken = (time) => Boolean(kept[time]?.ended);
  const running = () => Object.keys(TIMES).find((time) => kept[time] && !taken(time));

  const forms = [...box.querySelectorAll("form.quiz")].map((form) => {
    const whys = [...form.querySelector("template").content.children];
    const told = make("div", { className: "whys", hidden: true });
    const choices = [...form.querySelectorAll("label.choice")].map((label, k) => {
      const input = make("input", { type: "radio", name: form.id, value: "ABCDE"[k] });
      label.prepend(input);
      return input;
    });
    form.querySelector("fieldset").append(told);
    form.addEventListener("submit", (event) => event.preventDefault());
    form.addEventListener("change", () => {
      kept[running()].answers[form.id] = choices.find((input) => input.checked).value;
      keep();
      count();
    });
    return { form, choices, whys, told, right: choices[whys.findIndex((why) => why.matches(".right"))].value };
  });
  const answer = (time, { form }) => kept[time]?.answers[form.id] ?? "";
  const given = (time) => forms.filter((one) => answer(time, one)).length;
  const right = (time) => forms.filter((one) => answer(time, one) === one.right).length;

  // A question after the second time: both answers, and why.
  const explain = (one) => {
    const words = Object.keys(TIMES)
      .filter(taken)
      .map((time) => `${TIMES[time]}: ${answer(time, one) || "none"}.`);
    const shown = one.whys.filter(
      (why, k) => !one.choices[k] || [one.right, answer("after", one)].includes(one.choices[k].value),
    );
    const both = make("p", {}, make("strong", { textContent: words.join(" ") }));
    one.told.replaceChildren(both, ...shown.map((why) => why.cloneNode(true)));
  };

  const name = make("input", { type: "text", autocomplete: "off", spellcheck: false, maxLength: 60 });
  name.addEventListener("input", () => {
    kept.student = name.value.trim();
    keep();
  });
  const begin = Object.keys(TIMES).map((time) =>
    button(`Begin: ${TIMES[time].toLowerCase()}`, () => {
      kept[time] = { begun: now(), answers: {} };
      keep();
      show();
      forms[0].choices[0].focus();
    }),
  );
  const save = button("Save as a file", () => {
    if (!NAME.test(kept.student ?? "")) {
      told.textContent = "Type your name or number first: letters, digits and . @ - _ only.";
      return name.focus();
    }
    const head = ["student", "time", "question", "key", "answer", "begun", "ended"];
    const rows = Object.keys(TIMES).filter(taken).flatMap((time) =>
      forms.map((one, k) => {
        const { begun, ended } = kept[time];
        return [kept.student, time, k + 1, one.form.id, answer(time, one), begun, ended];
      }),
    );
    const text = [head, ...rows].map((row) => `${row.join(",")}\n`).join("");
    const href = URL.createObjectURL(new Blob([text], { type: "text/csv" }));
    make("a", { href, download: `twelve-questions-${kept.student}.csv` }).click();
    setTimeout(() => URL.revokeObjectURL(href), 10_000);
    told.textContent = "A file with your answers was saved.";
  });
  const erase = button("Erase my answers", () => {
    if (!confirm("Erase your name and your answers of both times?")) return;
    kept = {};
    keep();
    show("Erased. ");
    name.focus();
  });
  const told = make("p", { className: "quiz-told" });
  told.setAttribute("role", "status");
  const panel = make(
    "div",
    { className: "twice-panel" },
    make("label", {}, "Your name or number ", name),
    make("div", { className: "quiz-numbers" }, ...begin, save, erase),
    told,
  );

  let sure = false; // that some stay without an answer
  const far = make("p", { className: "quiz-told" });
  far.setAttribute("role", "status");
  const count = () => {
    sure = false;
    far.textContent = `${given(running())} of ${forms.length} answered`;
  };
  const finish = button("Finish", () => {
    const open = forms.flatMap((one, k) => (answer(running(), one) ? [] : [k + 1]));
    if (open.length && !sure) {
      sure = true;
      far.textContent = `Without an answer: ${open.join(", ")}. Press once more to finish all the same.`;
      return;
    }
    kept[running()].ended = now();
    keep();
    show();
    panel.scrollIntoView();
    save.focus({ preventScroll: true });
  });
  const bar = make("div", { className: "quiz-numbers twice-bar" }, finish, far);

  function show(first = "") {
    const time = running();
    name.value = kept.student ?? "";
    for (const one of forms) {
      one.form.hidden = !time && !taken("after");
      one.form.querySelector("fieldset").disabled = !time;
      const chosen = answer(time ?? "after", one);
      for (const input of one.choices) input.checked = input.value === chosen;
      one.told.hidden = Boolean(time) || !taken("after");
      if (!one.told.hidden) explain(one);
    }
    begin[0].disabled = Boolean(kept.before || kept.after);
    begin[1].disabled = Boolean(time || kept.after);
    save.disabled = !Object.keys(TIMES).some(taken);
    bar.hidden = !time;
    if (time) count();
    const done = Object.keys(TIMES).filter(taken);
    const said = taken("after")
      ? done.map((each) => `${TIMES[each]}: ${right(each)} of ${forms.length} right.`)
      : done.map((each) => `${TIMES[each]}: ${given(each)} of ${forms.length} answered. Save them as a file.`);
    const lost = remembers ? [] : ["This browser keeps nothing: save a file before you leave the page."];
    told.textContent = first + [...said, ...lost].join(" ");
  }
  addEventListener("storage", ({ key }) => {
    if (key !== KEY) return; // another tab, or all work was erased
    read();
    show();
  });

  read();
  document.documentElement.dataset.quiz = "";
  box.prepend(panel);
  box.append(bar);
  show();
})();
