// Exercises whose answer is a number, some numbers or a word are judged where they stand: the page
// brings what it has to know (book/workshop/chapters/exercises.py), nothing leaves the device.
(() => {
  const make = (tag, set = {}, ...inside) => {
    const made = Object.assign(document.createElement(tag), set);
    made.append(...inside);
    return made;
  };

  const NAMED = { sqrt: Math.sqrt, "√": Math.sqrt, log: Math.log, ln: Math.log, exp: Math.exp };

  // A number as people write it, NaN if it is none: 1/3, 0,5, −2, 50 %, 3,600 s, 2 ** 0.5, 1 - 1/√10.
  const number = (text) => {
    const plain = text
      .trim()
      .toLowerCase()
      .replace(/[−–]/g, "-")
      .replace(/[·×]/g, "*")
      .replace(/\b(np|math)\./g, "")
      .replace(/\b[1-9]\d{0,2}(,\d{3})+\b/g, (digits) => digits.replaceAll(",", ""))
      .replace(/(\d)[_\u00a0\u2009\u202f ](?=\d{3})/g, "$1")
      .replace(/(\d),(\d)/g, "$1.$2")
      .replace(/([\d)])\s*(°|(?!pi$)[a-zµ][^\d+*()]*([a-z]\^?[23])?)$/, "$1"); // a unit
    const pattern = /\s*((?:\d+\.?\d*|\.\d+)(?:e[-+]?\d+)?|\*\*|[a-z]+|\S)/y;
    const tokens = [...plain.matchAll(new RegExp(pattern, "g"))].map(([, token]) => token);
    const next = (...wanted) => (wanted.includes(tokens[0]) ? tokens.shift() : undefined);
    const sum = () => {
      let value = product();
      for (let sign; (sign = next("+", "-")); ) value += sign === "+" ? product() : -product();
      return value;
    };
    const product = () => {
      let value = signed();
      for (let sign; (sign = next("*", "/")); ) value *= sign === "*" ? signed() : 1 / signed();
      return value;
    };
    const signed = () => (next("-") ? -signed() : next("+") ? signed() : power());
    const power = () => {
      let value = atom();
      while (next("!")) value = value < 171 ? factorial(value) : NaN;
      if (next("%")) value /= 100;
      return next("**", "^") ? value ** signed() : value;
    };
    const factorial = (n) => (n === 0 ? 1 : n > 0 ? n * factorial(n - 1) : NaN);
    const atom = () => {
      const token = tokens.shift();
      if (token === "(") return [sum(), next(")") ? 0 : NaN].reduce((a, b) => a + b);
      if (token === "pi" || token === "π") return Math.PI;
      if (Object.hasOwn(NAMED, token)) return NAMED[token](atom());
      return /^[\d.]/.test(token) ? Number(token) : NaN;
    };
    const value = sum();
    return tokens.length ? NaN : value;
  };

  // Several numbers, with or without brackets, between commas or semicolons.
  const numbers = (text, count) => {
    const bare = text.trim().replace(/^\s*\w+\s*=/, "").replace(/[[\]]/g, "").trim();
    if (count === 1) return [number(bare)];
    const inside = bare.replace(/^\(([^()]*(?:\([^()]*\)[^()]*)*)\)$/, "$1");
    const ways = [/;/, /,\s+/, /,/].map((mark) => inside.split(mark));
    return (ways.find((parts) => parts.length === count) ?? ways.at(-1)).map(number);
  };

  const fits = ({ low, high, along, close }, values) => {
    if (low) return values.every((value, i) => value >= low[i] && value <= high[i]);
    const dot = (a) => a.reduce((sum, x, i) => sum + x * along[i], 0);
    const largest = (a) => Math.max(...a.map(Math.abs));
    const off = values.map((value, i) => value - (along[i] * dot(values)) / dot(along));
    return largest(values) > 0 && largest(off) <= close * largest(values);
  };

  const size = ({ low, along }) => (low ?? along)?.length;

  // A number as it is repeated: whole, or with six digits.
  const shown = (x) => {
    if (Number.isInteger(x) && Math.abs(x) < 1e15) return String(x + 0);
    return String(Number(x.toPrecision(6)));
  };

  const judge = ({ cases, otherwise, unit, options, unfit }, text) => {
    const count = size(cases[0]);
    if (!text.trim()) return "Write an answer first.";
    if (!count) {
      const word = text.replace(/^\s*mine\s*=|["'“”‘’.]/g, "").trim().toLowerCase();
      if (options.length && !options.includes(word)) return unfit;
      const said = cases.find((one) => one.word?.toLowerCase() === word)?.said ?? otherwise;
      return `${said} You gave "${word}".`;
    }
    const values = numbers(text, count);
    if (count > 1 && values.length !== count) return `Write ${count} numbers, with commas between.`;
    if (!values.every(Number.isFinite)) return count > 1 ? "Write numbers, with commas between." : "Write a number.";
    const said = cases.find((one) => size(one) === count && fits(one, values))?.said ?? otherwise;
    return `${said} You gave ${`${values.map(shown).join(", ")} ${unit}`.trim()}.`;
  };

  // What the cell above says of the answer, as in mine = ...  # a share, from 0 to 1. With a field
  // below that cell has nothing more to say, if it is all there is in it.
  const wanted = (place) => {
    let cell = place.closest(".cell");
    for (let k = 0; cell && k < 2; k += 1, cell = cell.previousElementSibling) {
      const code = cell.querySelector("pre")?.textContent.trim() ?? "";
      const [all, said] = code.match(/^mine = \.{3}(?:\s*# (.+))?$/m) ?? [];
      if (all) {
        cell.classList.toggle("is-asked-below", all === code);
        return said ?? "";
      }
    }
    return "";
  };

  document.querySelectorAll(".exercise-answer[data-judge]").forEach((place, k) => {
    const bytes = Uint8Array.from(atob(place.dataset.judge), (letter) => letter.charCodeAt(0));
    const known = JSON.parse(new TextDecoder().decode(bytes));
    const id = `answer-${k + 1}`;
    const field = make("input", { id, type: "text", autocomplete: "off", spellcheck: false });
    const told = make("output", { htmlFor: id });
    told.setAttribute("role", "status");
    const many = size(known.cases[0]) > 1;
    const label = make("label", { htmlFor: id }, many ? "Your answers" : "Your answer");
    const kind = wanted(place);
    if (kind) label.append(": ", make("span", { textContent: kind }));
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
