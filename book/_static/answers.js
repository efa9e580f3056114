// Exercises whose answer is a number, some numbers or a word are judged where they stand: the page
// brings what it has to know (book/workshop/chapters/exercises.py), nothing leaves the device.
(() => {
  const make = (tag, set = {}, ...inside) => {
    const made = Object.assign(document.createElement(tag), set);
    made.append(...inside);
    return made;
  };

  // A number as people write it: 1/3, 0,5, −2, 50 %.
  const number = (text) => {
    const plain = text.trim().replace(/−/g, "-").replace(/^(-?\d+),(\d+)/, "$1.$2");
    const [, top, below, part] = plain.match(/^([-+\d.e]+)(?:\s*\/\s*([\d.]+))?\s*(%)?$/i) ?? [];
    return top ? Number(top) / Number(below ?? 1) / (part ? 100 : 1) : NaN;
  };

  const judge = ({ cases, otherwise }, text) => {
    const [first] = cases;
    const word = text.trim().replace(/^["'“]|["'”]$/g, "").toLowerCase();
    if (!word) return "Write an answer first.";
    if (first.word !== undefined) {
      return cases.find((one) => one.word?.toLowerCase() === word)?.said ?? otherwise;
    }
    const count = first.low.length;
    const bare = text.replace(/[[\]()]/g, "");
    const parts = count > 1 ? bare.split(/[,;]\s+|;|,/) : [bare];
    const values = parts.map(number);
    if (!values.every(Number.isFinite)) return count > 1 ? "Write numbers, with commas between." : "Write a number.";
    if (values.length !== count) return `Write ${count} numbers, with commas between.`;
    const fits = ({ low, high }) =>
      low?.length === count && values.every((value, i) => value >= low[i] && value <= high[i]);
    return cases.find(fits)?.said ?? otherwise;
  };

  document.querySelectorAll(".exercise-answer[data-judge]").forEach((place, k) => {
    const bytes = Uint8Array.from(atob(place.dataset.judge), (letter) => letter.charCodeAt(0));
    const known = JSON.parse(new TextDecoder().decode(bytes));
    const id = `answer-${k + 1}`;
    const many = known.cases[0].low?.length > 1;
    const field = make("input", { id, type: "text", autocomplete: "off", spellcheck: false });
    const told = make("output", { htmlFor: id });
    told.setAttribute("role", "status");
    const label = make("label", { htmlFor: id, textContent: many ? "Your answers" : "Your answer" });
    const form = make("form", {}, label, field, make("button", { textContent: "Check" }), told);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      told.textContent = judge(known, field.value);
      form.classList.toggle("right", told.textContent.startsWith("Right"));
    });
    field.addEventListener("input", () => {
      told.textContent = "";
      form.classList.remove("right");
    });
    place.replaceChildren(form);
  });
})();
