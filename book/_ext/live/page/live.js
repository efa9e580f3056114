// *Run this page*: on a click, and not before, Python is loaded into a worker, and the open cells
// of the lesson can be changed and run. What follows from a change is marked, and runs alone.
(() => {
  const island = document.getElementById("live-page");
  if (!island) return;
  const { ahead, cells, data, megabytes, notebook, pages: known } = JSON.parse(island.textContent);
  const home = new URL(".", document.currentScript.src);
  const KEYS = "live:"; // one a page
  const MINE = KEYS + location.pathname;
  const FOLDER = MINE.slice(0, MINE.lastIndexOf("/") + 1); // the book's: a server may have others
  const ROOT = new URL("../../", home).pathname; // the site's
  const [REACT, QUIZ, TWICE] = ["live-react", "quiz", "quiz-twice"].map((key) => `${key}:${ROOT}`);
  const EXTENTS = `live-extents:${FOLDER.slice(KEYS.length)}`;
  const FORMAT = "direct-drive-work-1";

  const make = (tag, attributes = {}, ...inside) => {
    const el = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) el.setAttribute(name, value);
    el.append(...inside);
    return el;
  };
  const button = (text, label, act) => {
    const el = make("button", { type: "button", class: "btn btn-sm live-button" }, text);
    if (label) {
      el.setAttribute("aria-label", label);
      el.title = label;
    }
    el.addEventListener("click", act);
    return el;
  };

  const many = (count, what) => `${count} ${what}${count === 1 ? "" : "s"}`;

  // --- what a reader did: kept on this device until it is erased, if the browser keeps anything ---
  let blocked = false; // it keeps nothing: then it lasts as long as the page
  const read = (key) => {
    try {
      return JSON.parse(localStorage.getItem(key));
    } catch {
      return null;
    }
  };
  const write = (key, value) => {
    try {
      if (value === null) localStorage.removeItem(key);
      else localStorage.setItem(key, JSON.stringify(value));
      return true;
    } catch {
      blocked = true;
      return false;
    }
  };
  // Of each cell the book's code and the reader's, and of code from a file a third word: it was
  // "opened", and the book's runs in its place, until it is "accepted".
  const isText = (t) => typeof t === "string";
  const isChange = (c) => Array.isArray(c) && [2, 3].includes(c.length) && c.every(isText);
  const work = (record) => ({
    changes: Object.fromEntries(Object.entries(record?.changes ?? {}).filter(([, c]) => isChange(c))),
    solved: Array.isArray(record?.solved) ? record.solved.filter(isText) : [],
  });
  let mine = work(read(MINE));
  try {
    localStorage.length;
  } catch {
    blocked = true;
  }

  // Extents that the reader picked in one lesson, for those that follow: the text of a file.
  let extents = read(EXTENTS);
  const asExtents = (text) => (isText(text) && /^[\d\s.,[\]e+-]{0,999}$/.test(text) ? text : "");
  const picked = () => asExtents(blocked ? extents : read(EXTENTS));
  function pick(text) {
    extents = asExtents(text);
    write(EXTENTS, extents || null);
  }

  // Another tab may have written since: only what was changed in this one is written over it. What
  // was changed of cells that the book has no more, or with other code, stays.
  function remember() {
    const there = work(read(MINE) ?? (blocked ? mine : undefined));
    const touched = cells.filter((c) => c.area && c.area.value !== c.written);
    for (const { id, source, area, from } of touched) {
      const before = there.changes[id];
      if (before && before[0] !== source) there.changes[`${id}, earlier`] = before;
      if (area.value !== source) there.changes[id] = [source, area.value, from].filter(Boolean);
      else delete there.changes[id];
    }
    there.solved = [...new Set([...there.solved, ...mine.solved])];
    mine = there;
    const some = Object.keys(mine.changes).length;
    if (write(MINE, some || mine.solved.length ? mine : null))
      for (const cell of touched) cell.written = cell.area.value;
    tally();
    return cells.some((c) => c.area && c.area.value !== c.source);
  }

  // --- one button in the page's header, and its state beside it ---
  cells.forEach((cell, place) => {
    cell.el = document.querySelector(`[data-live="${cell.id}"]`);
    Object.assign(cell, { place, shown: cell.source, turn: 0, last: 0, asBuilt: cell.names });
  });
  const status = make("span", { class: "live-status", role: "status" });
  const press = button("Run this page", "", () => act());
  press.title = `Change this page's code and run it: loads ${megabytes[0]} to ${megabytes[1]} MB from this site`;
  document.querySelector(".article-header-buttons").prepend(status, press);
  const say = (text) => {
    if (status.textContent === text) return; // it is read out at each change
    status.textContent = text;
    status.classList.toggle("live-long", text.length > 40);
  };
  // The numbers to change may be some screens below: the state leads there.
  function invite() {
    const first = cells.find((c) => c.handles) ?? cells.find((c) => c.area);
    const link = make("a", { href: `#${first.el.closest("section").id}` }, "change a number");
    link.addEventListener("click", () => setTimeout(() => say(calm("ready"))));
    say("ready: now ");
    status.append(link);
  }
  const calm = (text) => [text, blocked && "your changes last until you leave"].filter(Boolean).join(": ");
  // What the button does follows what there is to do.
  let act = () => start();
  let stale = 0; // cells that may be out of date
  const isOn = () => "live" in document.documentElement.dataset;
  function face() {
    if (!isOn()) return;
    const busy = running || waiting.size;
    document.documentElement.dataset.live = busy ? "running" : "idle";
    const [words, does, title] = busy
      ? ["Stop", halt, "Stop what runs"]
      : stale
        ? ["Run what follows", followUp, "Run what follows from your changes"]
        : ["Run all", () => enqueue(cells, true), "Run all cells of this page"];
    act = does;
    if (press.textContent !== words) press.textContent = words;
    press.title = title;
  }

  const reset = button("Reset", "Reset: code and output as in the book", () => asBuilt());
  const react = make("input", { type: "checkbox", role: "switch", id: "live-react" });
  react.checked = read(REACT) === true;
  react.addEventListener("change", () => {
    write(REACT, react.checked || null);
    if (react.checked) followUp();
    else clearTimeout(timer);
  });
  const reacts = make("label", { class: "live-react", for: "live-react" });
  reacts.append(react, "React: what follows runs by itself");
  reacts.title = "It runs half a second after a change.";

  // What is kept, to be taken along and to be erased.
  const summary = make("summary");
  const own = make("details", { class: "live-own" }, summary);
  const heardOf = make("p", { class: "live-kept", role: "status" });
  const asked = cells.filter((c) => c.kind === "answer");
  function tally() {
    const done = asked.filter((c) => mine.solved.includes(c.id)).length;
    summary.textContent = `Solved: ${done} of ${asked.length}. Save or erase your work`;
    for (const cell of asked)
      if (cell.solved) cell.solved.textContent = mine.solved.includes(cell.id) ? "Solved" : "";
  }
  const chosen = make("input", { type: "file", accept: ".json,application/json", hidden: "" });
  chosen.addEventListener("change", () => takeIn(chosen.files[0]));
  own.append(
    make(
      "p",
      {},
      "Your changes and the exercises that you solved stay on this device. Nothing is sent. A small script " +
        "stays, too, which lets this site's pages stop Python at once. “Erase” takes all of it.",
    ),
    button("Save as a file", "Save as a file: your work on all pages of the book", () => takeOut()),
    button("Open a file", "Open a file with your work", () => chosen.click()),
    button("Erase", "Erase your work on all pages of the book", () => erase()),
    chosen,
    heardOf,
  );
  const keptNothing =
    "This browser keeps nothing for this site. Your changes last until you leave the page; “Save as a file” keeps them.";

  function pages() {
    const every = {};
    try {
      for (const key of Object.keys(localStorage))
        if (key.startsWith(FOLDER)) every[key.slice(FOLDER.length)] = work(read(key));
    } catch {
      blocked = true;
    }
    if (Object.keys(mine.changes).length || mine.solved.length) every[MINE.slice(FOLDER.length)] = mine;
    return every;
  }

  function takeOut() {
    remember();
    const content = JSON.stringify({ format: FORMAT, pages: pages(), extents: picked() }, null, 1);
    const address = URL.createObjectURL(new Blob([content], { type: "application/json" }));
    make("a", { href: address, download: "direct-drive-work.json" }).click();
    setTimeout(() => URL.revokeObjectURL(address), 10_000);
    heardOf.textContent = "A file with your work on all pages of the book was saved.";
  }

  // What somebody else wrote is a program. It is asked for, and shown; none of it runs with the rest.
  const LARGEST = 1_000_000; // bytes: all work on all pages is less
  const DISGUISED = /[\u202a-\u202e\u2066-\u2069]/; // signs that show code in another order than it has
  async function takeIn(file) {
    chosen.value = "";
    let content;
    try {
      if (file.size <= LARGEST) content = JSON.parse(await file.text());
    } catch {
      content = undefined;
    }
    if (content?.format !== FORMAT || !content.pages || typeof content.pages !== "object") {
      heardOf.textContent = "This file holds no work from this book. Nothing was changed.";
      return;
    }
    remember();
    const here = MINE.slice(FOLDER.length);
    const both = known.filter((page) => Object.hasOwn(content.pages, page)).map((page) => {
      const own = page === here ? mine : work(read(FOLDER + page));
      const { changes, solved } = work(content.pages[page]);
      const theirs = Object.entries(changes).filter(
        ([id, [, code]]) => own.changes[id]?.[1] !== code && !DISGUISED.test(code),
      );
      return { page, own, theirs, solved };
    }); // prettier-ignore
    const motions = asExtents(content.extents);
    const every = both.flatMap(({ own, theirs }) => theirs.map(([id]) => own.changes[id]));
    const over = every.filter(Boolean).length;
    const others = [
      over && `your own code of ${many(over, "cell")}`,
      motions && picked() && motions !== picked() && "the motions that you picked",
    ].filter(Boolean);
    const ask = [
      `The file holds code for ${many(every.length, "cell")} on ${many(both.length, "page")}.`,
      "None of it runs before you have pressed “Run” at its cell: read it first.",
      others.length ? `Take it in place of ${others.join(", and ")}?` : "Take it?",
    ];
    if (!confirm(ask.join(" "))) return (heardOf.textContent = "Nothing was changed.");
    for (const { page, own, theirs, solved } of both) {
      const opened = theirs.map(([id, [from, code]]) => [id, [from, code, "opened"]]);
      const changes = { ...own.changes, ...Object.fromEntries(opened) };
      const all = { changes, solved: [...new Set([...own.solved, ...solved])] };
      if (page === here) mine = all;
      write(FOLDER + page, all);
    }
    if (motions) {
      pick(motions);
      worker?.postMessage({ picked: motions });
    }
    for (const cell of cells) if (cell.area) setText(cell, keptText(cell));
    remember();
    mark();
    const taken = (count) => `The work on ${many(count, "page")} was taken.`;
    heardOf.textContent = blocked ? `${taken(1)} ${keptNothing}` : taken(both.length);
  }

  function erase() {
    if (!confirm("Erase your changes, what you solved and all quizzes, on all pages of this book?")) return;
    try {
      for (const key of Object.keys(localStorage)) if (key.startsWith(FOLDER)) write(key, null);
    } catch {
      blocked = true;
    }
    mine = work();
    write(QUIZ, null);
    write(TWICE, null);
    dispatchEvent(new StorageEvent("storage", { key: QUIZ })); // its questions hear of it
    pick("");
    worker?.postMessage({ picked: "" });
    write(REACT, null);
    react.checked = false;
    navigator.serviceWorker?.getRegistration(ROOT).then((found) => found?.unregister());
    if (cells.some((c) => c.area)) asBuilt(true);
    tally();
    heardOf.textContent = "Your work on all pages of this book was erased.";
  }

  tally();
  const other = Object.keys(mine.changes).filter(
    (id) => mine.changes[id][0] !== cells.find((c) => c.id === id)?.source,
  ).length;
  if (blocked) heardOf.textContent = keptNothing;
  else if (other)
    heardOf.textContent =
      `The book has changed the code of ${many(other, "cell")} since you did. Your code is not ` +
      "shown here; “Save as a file” has it.";
  if (asked.length) (asked[0].el.parentElement.querySelector(":scope > .rubric") ?? asked[0].el).before(own);
  if (blocked) say(calm(""));

  // --- cells ---
  // What runs: of code that a file brought, the book's own until the reader has accepted it.
  const text = (cell) => (cell.from === "opened" ? cell.source : (cell.area?.value ?? cell.source));
  function keptText(cell) {
    const [source, changed, from] = mine.changes[cell.id] ?? [];
    cell.from = source === cell.source ? from : undefined;
    return source === cell.source ? changed : cell.source;
  }
  function accept(cell) {
    if (cell.from !== "opened") return;
    cell.from = "accepted";
    cell.written = undefined; // it is kept with that word
    remember();
  }

  // What the editor offers: names of the cells above, and what objects of these have, if Python is
  // there and has nothing else to do.
  let editor, answered;
  const namesFor = ({ place }) => ({
    names: () =>
      cells.slice(0, place).flatMap(({ name, names: { writes = [], perhaps = [] } }) =>
        [...writes, ...perhaps].map((each) => [each, name]),
      ),
    parts(path, imported) {
      answered?.([]);
      answered = undefined;
      if (!ready || running) return [];
      const above = cells.slice(0, place + 1).filter((c) => c.turn).map((c) => c.name);
      worker.postMessage({ path, imported, above });
      return new Promise((resolve) => (answered = resolve));
    },
  });

  function open(cell, number) {
    const input = cell.el.querySelector(".cell_input");
    cell.name = `cell ${number + 1}`;
    cell.away = [];
    const caption = cell.el.querySelector(".cell_output figcaption");
    cell.output = make("div", {
      class: `live-output ${caption ? "" : "cell_output"}`,
      role: "group",
      "aria-label": `Output of ${cell.name}`,
    });
    if (caption) caption.before(cell.output);
    else cell.el.append(cell.output);
    if (cell.needs) {
      cell.output.append(note("torch", cell.needs));
      return;
    }
    const tools = make("div", { class: "live-tools" });
    cell.time = make("span", { class: "live-time" });
    cell.mark = make("span", { class: "live-mark" });
    cell.solved = make("span", { class: "live-solved" });
    const check = cell.kind === "check";
    const run = () => {
      accept(cell);
      const answer = check && cells[number - 1]; // as it stands now
      enqueue(answer && isBehind(answer) ? [answer, cell] : withCheck(number));
    };
    tools.append(
      button(check ? "Check" : "Run", `${check ? "Check the answer" : "Run"}: ${cell.name}`, run),
    );
    if (!check)
      tools.append(
        button("Run to here", `Run to here: all cells down to ${cell.name}`, () =>
          enqueue([...cells.slice(0, number), ...withCheck(number)]),
        ),
      );
    const answer = check && cells[number - 1];
    if (answer?.solution)
      tools.append(
        button("Run the solution", `Run the solution beside your answer: ${cell.name}`, () =>
          beside(answer, cell),
        ),
      );
    tools.append(cell.time, cell.solved, cell.mark);
    cell.tools = tools;
    if (check) {
      cell.output.before(tools);
      return;
    }
    const about = {
      class: "live-code",
      "aria-label": `Code of ${cell.name}`,
      "aria-describedby": "live-keys",
    };
    const plain = { spellcheck: "false", autocapitalize: "off", autocomplete: "off" };
    cell.area = editor?.(about, namesFor(cell)) ?? make("textarea", { ...about, ...plain });
    cell.area.value = cell.written = keptText(cell);
    cell.area.addEventListener("input", () => changed(cell));
    const keys = (event) => {
      if (event.key !== "Enter" || !(event.ctrlKey || event.metaKey || event.shiftKey)) return;
      event.preventDefault();
      event.stopPropagation();
      run();
    };
    cell.area.addEventListener("keydown", keys, { capture: true });
    cell.el.classList.remove("is-asked-below"); // the page's own field is no longer all there is
    input.hidden = true;
    input.after(cell.area, tools);
    if (cell.handles?.length) cell.el.closest("section").after(strip(cell));
    fit(cell);
  }

  function fit(cell) {
    cell.area.rows = cell.area.value.split("\n").length;
    if (cell.area.value === cell.source) cell.from = undefined;
    cell.el.classList.toggle("live-changed", cell.area.value !== cell.source);
    cell.handle?.();
  }

  function setText(cell, value) {
    if (cell.area.value !== value) cell.area.value = value;
    fit(cell);
  }

  const upToDate = () => calm(stale ? `${many(stale, "cell")} may be out of date` : "ready");

  function changed(cell) {
    fit(cell);
    remember();
    if (blocked) say((heardOf.textContent = keptNothing));
    mark();
    clearTimeout(timer);
    if (react.checked) timer = setTimeout(followUp, 500);
    else if (ready && !running && !blocked) say(upToDate());
  }

  // --- handles: the numbers of *Change this* ---
  const NUMBERS = /(?<![\w.\])])[-]?\d[\d_]*(?:\.\d*)?(?:[eE][-+]?\d+)?(?![\w(])/g;

  // Where a handle's number stands in the code as it is now; undefined if it is not there any more.
  function spotOf(cell, { target, place, count }) {
    let from = 0;
    for (const line of cell.area.value.split("\n")) {
      const sign = line.indexOf("=");
      if (sign > 0 && line.slice(0, sign).trim() === target) {
        const code = line.slice(sign + 1).replace(/#.*$/, "");
        const numbers = [...code.matchAll(NUMBERS)];
        if (numbers.length !== count) return undefined;
        const [written] = numbers[place];
        const start = from + sign + 1 + numbers[place].index;
        return { value: Number(written.replaceAll("_", "")), start, end: start + written.length };
      }
      from += line.length + 1;
    }
    return undefined;
  }

  const written = (value, { digits }) => value.toFixed(digits).replace(/(\.\d+?)0+$/, "$1");

  // One handle in a strip that stays in view, and a choice of those that move the cell in view.
  function strip(cell) {
    const choice = make("select", { "aria-label": "Handle: a number of Change this" });
    const range = make("input", { type: "range", id: "live-handle" });
    const shown = make("output", { for: range.id });
    const name = ({ label, unit }) => (unit ? `${label}, ${unit}` : label);
    const options = cell.handles.map((handle, k) => make("option", { value: k }, name(handle)));
    choice.append(...options);
    const panel = make("div", { class: "live-handles" }, choice, range, shown);
    const chosen = () => cell.handles[choice.value];
    const update = () => {
      const { low, high, step, unit } = chosen();
      const spot = spotOf(cell, chosen());
      Object.assign(range, { min: low, max: high, step, value: spot?.value ?? low, disabled: !spot });
      shown.textContent = spot?.value ?? "–";
      range.setAttribute("aria-label", name(chosen()));
      range.setAttribute("aria-valuetext", `${shown.textContent} ${unit}`.trim());
    };
    choice.addEventListener("change", update);
    range.addEventListener("input", () => {
      const spot = spotOf(cell, chosen());
      if (!spot) return;
      cell.area.setRangeText(written(Number(range.value), chosen()), spot.start, spot.end, "preserve");
      changed(cell);
    });
    const offer = ({ place }) => {
      const graph = follow.graph(cells);
      const before = cell.area.value;
      const moves = (handle) => {
        const { start, end } = spotOf(cell, handle) ?? {};
        const now = `${before.slice(0, start)}9e9${before.slice(end)}`;
        const only = new Map([[cell.place, follow.renamed(before, now)]]);
        return follow.after(cells, graph, [cell.place], only).has(place);
      };
      const those = options.filter((_, k) => moves(cell.handles[k]));
      if (!those.length) those.push(...options);
      const kept = options[choice.value];
      choice.replaceChildren(...those);
      if (those.includes(kept)) kept.selected = true;
      update();
    };
    const inView = new IntersectionObserver(
      (entries) => {
        const entry = entries.findLast(({ isIntersecting }) => isIntersecting);
        if (!entry || panel.querySelector(":focus-visible")) return; // it is in use by the keyboard
        offer(cells.find(({ el }) => el === entry.target));
      },
      { rootMargin: "-40% 0px" },
    );
    for (const { el } of cells) inView.observe(el);
    cell.handle = update;
    return panel;
  }

  // --- what follows from a change ---
  let timer;

  // Cells whose output is not what their code and the cells above give.
  function mark() {
    const different = cells.filter((c) => !c.needs && text(c) !== c.shown);
    const only = new Map();
    for (const cell of different)
      if (cell.handles) only.set(cell.place, follow.renamed(cell.shown, text(cell)));
    const first = cells.filter((c) => different.includes(c) || (c.stale && !c.needs));
    const later = follow.after(cells, follow.graph(cells), first.map((c) => c.place), only);
    stale = 0;
    for (const cell of cells) {
      if (!cell.mark) continue;
      const behind = cell.stale || later.has(cell.place);
      const words = different.includes(cell)
        ? "Changed, and not run since."
        : cell.from === "opened"
          ? "From a file: the book's own code runs in its place until you have read this and pressed “Run”."
          : behind
            ? "May show what came before your change."
            : "";
      stale += behind || different.includes(cell);
      if (cell.mark.textContent !== words) cell.mark.textContent = words;
      cell.el.classList.toggle("live-stale", behind);
    }
    face();
  }

  function followUp() {
    clearTimeout(timer);
    if (!isOn()) return; // Python is not asked for yet
    const first = cells.filter((c) => !c.needs && isBehind(c));
    const graph = follow.graph(cells);
    const later = follow.after(cells, graph, first.map((c) => c.place));
    if (running && (first.includes(running) || later.has(running.place))) cancel();
    else drop();
    if (first.length) enqueue(first, true);
  }

  // What is shown is not what the code gives.
  const isBehind = (cell) => text(cell) !== cell.shown || cell.stale || cell.failed;

  // An answer is judged as soon as it has run.
  const withCheck = (number) => {
    const next = cells[number + 1];
    const judged = cells[number].kind === "answer" && next?.kind === "check";
    return judged ? [cells[number], next] : [cells[number]];
  };

  // The solution runs where the answer stands, and what it gives to names is not kept.
  function beside(answer, check) {
    if (!answer.beside) {
      const output = make("div", { class: "live-output", role: "group" });
      output.setAttribute("aria-label", `Output of the solution of ${answer.name}`);
      const ours = make("div", {}, make("p", { class: "live-head" }, "The solution"), output);
      const yours = make("div", {}, make("p", { class: "live-head" }, "Your answer"));
      const both = make("div", { class: "live-beside" }, yours, ours);
      check.output.before(both);
      yours.append(check.output);
      answer.beside = {
        name: `solution of ${answer.name}`, place: answer.place, el: check.el, output, built: [],
        source: `${answer.solution}\n${check.source}`, names: answer.solves, extra: true, away: [],
        kind: "solution", time: check.time,
      }; // prettier-ignore
    }
    enqueue([answer.beside]);
  }

  // What the book shows makes room for what the reader's code gives: two figures may share an id.
  const OUTPUTS = '.cell_output :is(.output, .ddlib-widget, script[type*="widget-view"])';
  function fresh(cell) {
    const first = (el) => !el.closest(".live-output") && !el.parentElement.closest(".output, .ddlib-widget");
    cell.el.style.minBlockSize = `${cell.el.offsetHeight}px`; // nothing below moves until it ran
    cell.built ??= [...cell.el.querySelectorAll(OUTPUTS)].filter(first);
    for (const el of cell.built) {
      const mark = new Comment();
      el.replaceWith(mark);
      cell.away.push([mark, el]);
    }
    cell.built = [];
    emptied(cell);
  }

  function emptied(cell) {
    for (const widgets of hosts) widgets.drop(cell.output);
    cell.output.replaceChildren();
  }

  function restore(cell) {
    for (const [mark, el] of cell.away) mark.replaceWith(el);
    cell.away = [];
    cell.built = undefined; // what stands there
  }

  function asBuilt(sure = false) {
    const ask = "Drop your changes and show code and output of the book?";
    if (!sure && remember() && !confirm(ask)) return;
    for (const cell of cells) {
      restore(cell);
      emptied(cell);
      cell.output.append(...(cell.needs ? [note("torch", cell.needs)] : []));
      if (cell.beside) emptied(cell.beside);
      Object.assign(cell, { shown: cell.source, stale: false, failed: false, asked: false });
      Object.assign(cell, { names: cell.asBuilt, prints: undefined, altered: undefined });
      if (cell.time) cell.time.textContent = "";
      if (cell.area) setText(cell, cell.source);
    }
    remember();
    clearTimeout(timer);
    drop();
    meanwhile = "the book's again: Python starts afresh";
    restart();
    mark();
  }

  // --- what comes from the worker ---
  function note(kind, text = "") {
    const link = make("a", { href: notebook, download: "" }, "download the notebook");
    const sentence = {
      torch: () => [`This cell needs ${text}, not available in the page: `, link, "."],
      twin: () => [
        "PyTorch is not available in a page: a small stand-in computes the same with numpy.",
      ],
      above: () => [`This cell needs “${text}” of a cell above that needs PyTorch: `, link, "."],
      after: () => ["A cell above needs PyTorch and did not run; this may follow: ", link, "."],
      hint: () => [`Is “${text}” made in a cell above? “Run to here” runs them all.`],
      syntax: () => {
        const [line, why] = JSON.parse(text);
        const where = line ? `line ${line} of this cell` : "this cell";
        return [`Python cannot read ${where}${why ? ` (${why})` : ""}. Nothing of the cell ran.`];
      },
      memory: () => [
        "This needs more memory than a page has. Nothing that you wrote is lost: make it smaller, or ",
        link,
        " and run it on your own machine.",
      ],
      stopped: () => [`Stopped. ${text}`],
      foreign: () => [
        "A figure to handle is not shown after code from a file has run: its script would run in " +
          "this page. “Reset” starts Python afresh.",
      ],
      ended: () => [
        "Stopped. A cell that computes hears nothing, so Python was ended and starts afresh. " +
          "Your code and all other output stay; the next run first does again what it needs of " +
          "the cells above.",
      ],
      lost: () => [
        `Python broke off${text ? ` (${text})` : ""} and starts afresh with the next run. Nothing ` +
          "that you wrote is lost.",
      ],
    }[kind];
    return sentence ? make("p", { class: "live-note" }, ...sentence()) : "";
  }

  function printed(text, kind) {
    const el = make("div", { class: `output stream live-${kind}` }, make("pre", {}, text));
    return el;
  }

  // As MathJax is told to read them on the book's pages.
  const formulas = (text) =>
    text.replaceAll("\\|", "|").replaceAll("&lt;", "<").replace(/(\$\$?)(.+?)\1/gs, (_, sign, tex) =>
      sign === "$" ? `\\(${tex}\\)` : `\\[${tex}\\]`,
    );

  function table(text) {
    const rows = text.trim().split("\n");
    const parts = (row) => row.replace(/^\|\s*|\s*\|\s*$/g, "").split(/(?<!\\)\|/);
    const cellsOf = (row, tag) =>
      make("tr", {}, ...parts(row).map((t) => make(tag, {}, formulas(t.trim()))));
    return make(
      "section", // as on the book's pages: a div that scrolls has no role
      { class: "pst-scrollable-table-container" },
      make(
        "table",
        { class: "table" },
        make("thead", {}, cellsOf(rows[0], "th")),
        make("tbody", {}, ...rows.slice(2).map((row) => cellsOf(row, "td"))),
      ),
    );
  }

  // Of a Python in which code from a file ran, nobody knows what it makes even of the book's cells:
  // HTML shows in a frame in which no script runs, and scripts of widgets do not come at all.
  const FORMED = new Set(["html", "figure", "markdown", "latex", "widget"]);
  function framed(kind, text) {
    if (kind === "widget") return [note("foreign")];
    if (kind === "markdown" || kind === "latex") return [printed(text, "text")];
    const el = make("iframe", { sandbox: "allow-same-origin", class: "output", title: "Output" });
    const styles = [...document.querySelectorAll('link[rel="stylesheet"]')].map((link) => link.outerHTML);
    const own = `'unsafe-inline' ${location.origin}`;
    const policy = `default-src 'none'; img-src data:; style-src ${own}; font-src ${location.origin}`;
    const head = `<meta http-equiv="Content-Security-Policy" content="${policy}">${styles.join("")}`;
    const theme = document.documentElement.dataset.theme ?? "light";
    const body = `<body class="bd-article"><div class="live-output">${text}</div></body>`;
    el.srcdoc = `<!doctype html><html data-theme="${theme}">${head}${body}</html>`;
    el.addEventListener("load", () => {
      const height = el.contentDocument.body.firstElementChild?.scrollHeight ?? 0;
      el.style.blockSize = `${Math.min(height + 8, 2000)}px`;
    });
    return [el];
  }

  function show(cell, kind, text) {
    const place = cell.output;
    if (kind === "again") return emptied(cell);
    if (foreign && FORMED.has(kind)) return place.append(...framed(kind, text));
    if (kind === "text" || kind === "warning" || kind === "error") {
      const last = place.lastElementChild;
      if (last?.classList.contains(`live-${kind}`)) last.firstChild.append(text);
      else place.append(printed(text, kind));
      if (kind === "text") cell.printed = (cell.printed ?? "") + text;
    } else if (kind === "html" || kind === "figure") {
      const el = make("div", { class: `output text_html ${kind === "figure" ? "live-wide" : ""}` });
      el.innerHTML = text;
      place.append(el);
    } else if (kind === "markdown" || kind === "latex") {
      const plain = kind === "latex" || !text.startsWith("|");
      const el = plain ? make("div", {}, formulas(text)) : table(text);
      el.classList.add("output", "tex2jax_process");
      place.append(el);
      window.MathJax?.typesetPromise?.([el]);
    } else if (kind === "progress") {
      const [share, what] = JSON.parse(text);
      cell.gauge ??= make("progress", { max: 1, "aria-label": `Progress of ${cell.name}` });
      cell.gauge.value = share;
      if (!cell.gauge.isConnected) cell.time.after(cell.gauge);
      cell.time.textContent = `running: ${what ? `${what}, ` : ""}${Math.floor(100 * share)} %`;
    } else if (kind === "widget") {
      cell.widget = true;
      const el = make("div", { class: "output" });
      place.append(el);
      withHost(() => host.mount(Number(text), el));
    } else place.append(note(kind, text));
  }

  // --- widgets: their script comes with the first one ---
  const hosts = []; // one for each worker that had any
  let host, hosting;
  function withHost(act) {
    hosting ??= import(new URL("widgets.mjs", home)).then((module) => {
      const mine = worker;
      const post = (message, buffers) => mine.postMessage({ widget: JSON.stringify(message), buffers });
      host = module.host(post, () => Boolean(running));
      hosts.push(host);
    });
    hosting = hosting
      .then(() => void (host && act()))
      .catch((error) => say(`The figure to handle did not come: ${error.message}.`));
  }
  function ended() {
    worker?.terminate();
    worker = undefined;
    host?.end();
    host = hosting = undefined;
  }

  // --- the worker, and what is to be run ---
  const runs = (cell) => `running ${cell.name}${cell.extra ? "" : ` of ${cells.length}`}`;
  let foreign; // whether code from a file has run in this Python
  let worker, ready, running, expected, loaded, interrupts, turns;
  let meanwhile = ""; // what is said while Python starts afresh and nobody waits for it
  let ran = 0; // cells, since something was asked for
  let spread = false; // whether what follows runs, too
  let patience = 5000; // ms: a restart takes so long
  const waiting = new Set(); // cells
  const drop = () => {
    for (const cell of waiting) cell.asked = false;
    waiting.clear();
  };
  const isolated = globalThis.crossOriginIsolated && globalThis.SharedArrayBuffer;

  function boot() {
    import(new URL("widgets.mjs", home)).catch(() => {}); // there when a widget comes, with no network too
    worker = new Worker(new URL("worker.mjs", home), { type: "module" });
    ready = foreign = false;
    loaded = turns = 0;
    for (const cell of cells) cell.turn = cell.last = 0;
    expected = megabytes[0] * 1e6;
    advance(0);
    const [began, mine] = [performance.now(), worker];
    worker.onmessage = ({ data: message }) => {
      if (mine !== worker) return;
      if (message.ready) patience = Math.max(3000, performance.now() - began);
      if (message.lives) navigator.locks.request(message.lives, () => mine === worker && lost("it was ended"));
      else heard(message);
    };
    worker.onerror = (event) => {
      event.preventDefault?.();
      if (mine === worker) heard({ failed: event.message || "its files are not on this site" });
    };
    interrupts = isolated ? new Uint8Array(new SharedArrayBuffer(1)) : undefined;
    const files = data.map((name) => `data/${name}`);
    worker.postMessage({ start: files, ahead, interrupts, picked: picked() });
  }

  function advance(bytes) {
    loaded += bytes;
    const share = Math.min(100, Math.round((100 * loaded) / expected));
    press.style.setProperty("--loaded", `${share}%`);
    if (!ready) say(meanwhile || "starting Python");
    else if (running) say(`${runs(running)}: loading`);
  }

  // On a wide page a figure comes at once, in this form alone; the narrow one comes if it is needed.
  const slim = matchMedia("(max-width: 600px)"); // as in the book's style sheet
  slim.addEventListener("change", () => slim.matches && worker?.postMessage({ forms: true }));

  function inBoth({ form, number, text }) {
    const cell = cells.flatMap((c) => [c, c.beside]).find((c) => c?.name === form);
    const el = cell?.output.querySelectorAll(".live-wide")[number];
    if (el) el.innerHTML = text;
  }

  function heard(message) {
    if (foreign && (message.form || message.widget)) return;
    if (message.form) inBoth(message);
    else if (message.parts) answered?.(message.parts.filter(isText));
    else if (message.picked !== undefined) pick(message.picked);
    else if (message.widget) withHost(() => host.heard(message.widget, message.buffers));
    else if (message.bytes) {
      advance(message.bytes);
    } else if (message.ready) {
      ready = true;
      expected = megabytes[1] * 1e6;
      say(meanwhile || upToDate());
      next();
    } else if (message.failed) lost(message.failed);
    else if (message.kind === "moved") moved(message.names);
    else if (message.done) finish(message);
    else if (running && message.run === running.name) {
      const { kind, text } = message;
      if (kind === "names") {
        if (!running.extra) running.news = JSON.parse(text);
        return;
      }
      if (running.cancelled) return;
      if (kind === "error" || kind === "stopped") running.failed = true;
      if (kind === "after") running.failed = false; // cells below may do without
      show(running, kind, text);
    }
  }

  // A figure was handled, and Python has its names: cells that take them follow, but for those that
  // set it themselves, which would undo what the reader did.
  function moved(names) {
    const graph = follow.graph(cells);
    for (const name of names)
      for (const cell of cells) {
        const { names: own } = cell;
        if (!own.writes?.includes(name) && !own.perhaps?.includes(name)) continue;
        for (const k of follow.readers(cells, graph, cell.place, new Set([name])))
          if (cells[k].kind !== "answer" && cells[k] !== running && !graph[k].changes.has(name))
            cells[k].stale = true;
      }
    mark();
    clearTimeout(timer);
    if (react.checked) timer = setTimeout(followUp, 500);
  }

  // The worker is gone: the page goes on, and the next run has another one.
  function lost(why) {
    drop();
    ended();
    if (running) {
      running.output.append(note("lost", why));
      released(running);
      if (!running.extra) running.failed = true;
    }
    running = undefined;
    say(`Python ${ready ? "broke off" : "did not start"}: ${why}.`);
    mark();
  }

  function released(cell, time = "") {
    cell.el.classList.remove("live-running");
    cell.el.style.minBlockSize = "";
    cell.gauge?.remove();
    if (cell.time) cell.time.textContent = time;
  }

  // A cell with all that it may read: of code that was changed and has not run yet, any word.
  function asItStands(cell) {
    if (cell.extra || text(cell) === cell.shown) return cell;
    const words = text(cell).match(/[\p{L}_][\p{L}\p{N}_]*/gu) ?? [];
    const reads = [...new Set([...(cell.names.reads ?? []), ...words])];
    return { ...cell, names: { ...cell.names, reads } };
  }

  // The next cell, after the cells above that have to run before it: what it needs of them is not
  // in this worker yet, or was changed in place since.
  function prepared() {
    for (let tries = 0; tries < 1000; tries++) {
      const cell = [...waiting].sort((a, b) => a.place - b.place)[0];
      if (!cell) return undefined;
      const those = cells.with(cell.place, asItStands(cell));
      const graph = follow.graph(those);
      const lists = [...graph[cell.place].from.values()].flat();
      // of code that was changed and has not run yet, nobody knows what it needs
      const above = text(cell) === cell.shown || cell.extra ? [] : cells.slice(0, cell.place);
      const needed = [...lists.map((k) => cells[k]), ...above.filter((c) => c.kind === "open")];
      const missing = needed.filter((c) => !c.turn && !c.needs && !waiting.has(c));
      const bad = missing.length || cell.extra ? undefined : spoiled(graph, cell.place);
      if (!missing.length && !bad) return cell;
      for (const other of missing) waiting.add(other);
      if (bad) for (const other of bad) waiting.add(other);
    }
    return undefined;
  }

  function spoiled(graph, place) {
    const broken = follow.spoiled(graph, place, cells.map((c) => c.last));
    if (!broken) return undefined;
    const { maker, name } = broken;
    cells[maker].turn = 0;
    const others = cells.filter((_, k) => {
      const { changes, from } = graph[k];
      return k > maker && changes.has(name) && from.get(name)?.at(-1) === maker && cells[k].last;
    });
    for (const cell of others) cell.turn = 0; // whoever needs them has them run, after an error too
    return [cells[maker], ...others];
  }

  function next() {
    if (!ready || running) return;
    running = prepared();
    if (!running) return face();
    waiting.delete(running);
    const cell = running;
    cell.sent = text(cell);
    foreign ||= Boolean(cell.from) && cell.sent !== cell.source;
    cell.quiet = !cell.asked && !cell.stale && !cell.failed && cell.sent === cell.shown && !cell.widget;
    cell.failed = cell.cancelled = cell.stopping = false;
    cell.news = undefined;
    cell.printed = "";
    if (!cell.quiet) fresh(cell);
    cell.el.classList.add("live-running");
    if (cell.time && !cell.quiet) cell.time.textContent = "running …";
    say(runs(cell));
    host?.flush();
    const above = cells.slice(0, cell.place).filter((c) => c.turn).map((c) => c.name);
    const how = { keep: !cell.extra, quiet: cell.quiet, wide: !slim.matches };
    if (interrupts) interrupts[0] = 0;
    worker.postMessage({ run: cell.name, source: cell.sent, above, how });
  }

  function finish({ seconds, ok }) {
    const cell = running;
    running = undefined;
    press.style.removeProperty("--loaded");
    released(cell, cell.quiet ? cell.time?.textContent : `${seconds.toFixed(1)} s`);
    if (cell.cancelled && !ok) {
      cell.stale = true;
      cell.turn = 0;
      cell.last = ++turns; // half of it ran, and may have changed what is above
      if (spread && !cell.extra) waiting.add(cell);
    } else if (!cell.extra) settled(cell);
    if (cell.failed) drop();
    cell.asked = false;
    mark();
    ran += !cell.quiet;
    if (!waiting.size) {
      if (cell.failed) say(`${cell.stopping ? "stopped" : "an error"} in ${cell.name}`);
      else if (ran === cells.length && !stale) invite();
      else say(upToDate());
      ran = 0;
    }
    next();
  }

  // What a cell gave to names, against what it gave before: cells below take what differs.
  function settled(cell) {
    const before = cell.shown;
    cell.turn = cell.last = ++turns;
    cell.shown = cell.sent;
    cell.stale = false;
    if (cell.kind === "check" && cell.printed.startsWith("Right")) {
      const { id } = cells[cell.place - 1];
      if (!mine.solved.includes(id)) mine.solved.push(id);
      remember();
    }
    const { prints, altered, ...names } = cell.news ?? {};
    if (!prints) return; // no Python: nothing ran
    const old = cell.prints ?? (before === cell.sent ? prints : {});
    const { writes = [], perhaps = [], changes = [] } = cell.names;
    const gave = cell.prints ? Object.keys(old) : [...Object.keys(old), ...writes, ...perhaps];
    const once = [...gave, ...(cell.altered ?? changes)];
    const given = new Set([...once, ...Object.keys(prints), ...altered]);
    const fine = (name) => cell.prints === undefined && before === cell.sent;
    const earlier = follow.graph(cells); // with names that the cell gives or changes no more
    cell.names = names;
    cell.altered = altered;
    cell.prints = prints;
    const graph = follow.graph(cells);
    const remade = new Set();
    for (const [k, { from, changes }] of graph.entries())
      for (const name of changes)
        if (k > cell.place && from.get(name)?.includes(cell.place) && cells[k].last) {
          remade.add(name);
          if (!spread && !cell.quiet) continue;
          waiting.add(cells[k]);
          cells[k].turn = 0;
        }
    const differs = new Set(
      [...given].filter((name) => !fine(name) && (!prints[name] || prints[name] !== old[name])),
    );
    if (!cell.quiet) for (const name of remade) differs.add(name);
    else for (const name of [...differs]) if (!prints[name]) differs.delete(name);
    const readers = [earlier, graph].flatMap((g) => follow.readers(cells, g, cell.place, differs));
    for (const k of new Set(readers)) {
      const reader = cells[k];
      if (reader.asked && waiting.has(reader)) continue;
      if (reader.kind === "answer" || reader.needs) continue;
      reader.stale = true;
      if (spread) waiting.add(reader);
    }
  }

  function enqueue(more, on = false) {
    meanwhile = "";
    spread = on;
    for (const cell of more) {
      cell.asked = true;
      waiting.add(cell);
    }
    if (!worker) boot();
    face();
    next();
  }

  // Ask what runs to stop. A worker hears it where memory is shared.
  function ask() {
    if (interrupts) interrupts[0] = 2;
    return interrupts;
  }

  // What runs is out of date. It may end by itself; it has as long as a restart would take.
  function cancel() {
    drop();
    const cell = running;
    if (cell.cancelled) return;
    cell.cancelled = true;
    ask();
    const mine = worker;
    setTimeout(() => {
      if (mine !== worker || running !== cell || !cell.cancelled) return;
      cell.stale = true;
      if (!cell.extra) waiting.add(cell);
      restart();
    }, patience);
  }

  function restart(time = "") {
    ended();
    if (running) released(running, time);
    running = undefined;
    boot();
  }

  function halt() {
    clearTimeout(timer);
    drop();
    const cell = running;
    if (!cell) return ready || asBefore();
    cell.stopping = true;
    const end = () => {
      if (running !== cell || !cell.stopping) return;
      cell.output.append(note("ended"));
      if (!cell.extra) cell.failed = true;
      meanwhile = "stopped: Python starts afresh";
      restart("stopped");
      mark();
    };
    if (ask()) setTimeout(end, 3000);
    else end();
  }

  // Stopped before Python was there: what was to be run waits for a click.
  function asBefore() {
    for (const cell of cells) cell.asked = false;
    meanwhile = "stopped before the first cell";
    say(meanwhile);
    face();
  }

  // In a page that shares memory with its worker, Stop is heard at once. For that a page needs two
  // headers, which isolate.js adds from the next load on. Without, Stop ends Python, and says so.
  const AGAIN = `live-again:${ROOT}`; // the page is loaded once more, and then begins by itself
  async function isolate() {
    try {
      if (isolated || sessionStorage.getItem(AGAIN)) return false;
      await navigator.serviceWorker.register(`${ROOT}isolate.js`);
      await Promise.race([navigator.serviceWorker.ready, new Promise((_, no) => setTimeout(no, 3000))]);
      sessionStorage.setItem(AGAIN, scrollY);
      location.reload();
      return true;
    } catch {
      return false; // an old browser, a private window, or a page that came without encryption
    }
  }
  try {
    const place = sessionStorage.getItem(AGAIN);
    if (place) {
      start().then(() => sessionStorage.removeItem(AGAIN));
      addEventListener("load", () => scrollTo({ top: place, behavior: "instant" }));
    }
  } catch {
    // there is no such storage
  }

  async function start() {
    if (location.protocol === "file:") {
      status.classList.add("live-long");
      status.replaceChildren(
        "A browser runs Python only in pages that come from a server, not from a folder. In the " +
          "folder of this site run ",
        make("code", {}, "python -m http.server"),
        " and open ",
        make("code", {}, `http://localhost:8000/${location.pathname.split("/").slice(-2).join("/")}`),
        ".",
      );
      return;
    }
    say("starting Python");
    if (isOn() || (await isolate())) return;
    document.documentElement.dataset.live = "running";
    editor = await import(new URL("editor.js", home)).then((module) => module.editor, () => undefined);
    cells.forEach(open);
    tally();
    const keys =
      "Ctrl+Enter or Shift+Enter runs a cell." +
      (editor ? " Tab indents after you typed, or takes a name; Escape, then Tab, leaves the code." : "");
    const rest = make("div", { class: "live-rest" }, reacts, reset, make("p", { id: "live-keys" }, keys));
    (cells.find((c) => c.handles) ?? cells[0]).el.before(rest);
    mark();
    enqueue(cells, true);
  }
})();
