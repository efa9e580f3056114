// *Run this page*: on a click, and not before, Python is loaded into a worker, and the open cells
// of the lesson can be changed and run.
(() => {
  const island = document.getElementById("live-page");
  if (!island) return;
  const { cells, data, megabytes, notebook } = JSON.parse(island.textContent);
  const home = new URL(".", document.currentScript.src);
  const MINE = `live:${location.pathname}`;

  const make = (tag, attributes = {}, ...inside) => {
    const el = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) el.setAttribute(name, value);
    el.append(...inside);
    return el;
  };
  const button = (text, label, act) => {
    const el = make("button", { type: "button", class: "btn btn-sm live-button" }, text);
    if (label) el.setAttribute("aria-label", label);
    el.addEventListener("click", act);
    return el;
  };

  // --- what a reader changed: kept until reset, if the browser keeps anything ---
  const recall = () => {
    try {
      return JSON.parse(localStorage.getItem(MINE)) ?? {};
    } catch {
      return {};
    }
  };
  const remember = () => {
    const changed = cells.filter((c) => c.area && c.area.value !== c.source);
    const kept = Object.fromEntries(changed.map((c) => [c.id, [c.source, c.area.value]]));
    try {
      if (changed.length) localStorage.setItem(MINE, JSON.stringify(kept));
      else localStorage.removeItem(MINE);
    } catch {
      // it lasts as long as the page
    }
    return changed.length;
  };

  // --- the bar above the first cell ---
  for (const cell of cells) cell.el = document.querySelector(`[data-live="${cell.id}"]`);
  const bar = make("section", { class: "live-bar", "aria-label": "Run this page" });
  const status = make("p", { class: "live-status", role: "status" });
  const progress = make("div", {
    role: "progressbar",
    class: "live-progress",
    "aria-label": "Loading Python",
    "aria-valuemin": 0,
    "aria-valuemax": 100,
    hidden: "",
  });
  progress.append(make("span"));
  const begin = button("Run this page", "", () => start());
  const all = button("Run all", "", () => enqueue(cells));
  const stop = button("Stop", "Stop: what runs is ended, Python starts afresh", () => stopped());
  const reset = button("Reset", "Reset: code and output as in the book", () => asBuilt());
  const changes = Object.keys(recall()).length;
  const lacks = cells.filter((c) => c.needs).map((c) => c.needs);
  status.textContent =
    `Change the code of this page and run it, here in the browser. A click loads Python from ` +
    `this site: ${megabytes[0]} MB, up to ${megabytes[1]} MB with all that cells import. The first ` +
    `run takes half a minute more than the page says.` +
    (lacks.length ? ` PyTorch's ${lacks.join(", ")} are not in a page: the notebook has them.` : "") +
    (changes ? " What you changed last time is kept." : "");
  bar.append(begin, status, progress);
  // Beside the sections of the page, not in one: so it stays in view down to the last cell.
  let place = cells[0].el;
  while (place.parentElement.parentElement.closest("section")) place = place.parentElement;
  place.before(bar);

  const say = (text) => {
    if (status.textContent !== text) status.textContent = text; // it is read out at each change
  };

  // --- cells ---
  function open(cell, number) {
    const input = cell.el.querySelector(".cell_input");
    cell.name = `cell ${number + 1}`;
    cell.built = [...cell.el.querySelectorAll(".cell_output .output")];
    cell.away = [];
    const caption = cell.el.querySelector(".cell_output figcaption");
    cell.told = make("div", {
      class: `live-output ${caption ? "" : "cell_output"}`,
      role: "group",
      "aria-label": `Output of ${cell.name}`,
    });
    if (caption) caption.before(cell.told);
    else cell.el.append(cell.told);
    if (cell.needs) {
      cell.told.append(note("torch", cell.needs));
      return;
    }
    const tools = make("div", { class: "live-tools" });
    cell.time = make("span", { class: "live-time" });
    const check = cell.kind === "check";
    tools.append(
      button(check ? "Check" : "Run", `${check ? "Check the answer" : "Run"}: ${cell.name}`, () =>
        enqueue(withCheck(number)),
      ),
    );
    if (!check)
      tools.append(
        button("Run to here", `Run to here: all cells down to ${cell.name}`, () =>
          enqueue([...cells.slice(0, number), ...withCheck(number)]),
        ),
      );
    tools.append(cell.time);
    cell.tools = tools;
    if (check) {
      cell.told.before(tools);
      return;
    }
    const [from, mine] = recall()[cell.id] ?? [];
    cell.area = make("textarea", {
      class: "live-code",
      spellcheck: "false",
      autocapitalize: "off",
      autocomplete: "off",
      "aria-label": `Code of ${cell.name}`,
      "aria-describedby": "live-keys",
    });
    cell.area.value = from === cell.source ? mine : cell.source;
    const fit = () => {
      cell.area.rows = cell.area.value.split("\n").length;
      cell.el.classList.toggle("live-changed", cell.area.value !== cell.source);
    };
    // Tab indents once something was typed here; it leaves a cell that is passed through, and
    // after Escape: nobody is trapped.
    let indents = false;
    cell.area.addEventListener("focus", () => (indents = false));
    cell.area.addEventListener("pointerdown", () => setTimeout(() => (indents = true)));
    cell.area.addEventListener("input", () => {
      indents = true;
      fit();
      remember();
    });
    cell.area.addEventListener("keydown", (event) => {
      if (event.key === "Enter" && (event.ctrlKey || event.metaKey)) {
        event.preventDefault();
        enqueue(withCheck(number));
      } else if (event.key === "Escape") indents = false;
      else if (event.key === "Tab" && indents && !event.shiftKey && !event.ctrlKey) {
        event.preventDefault();
        document.execCommand("insertText", false, "    "); // so that it can be undone
      }
    });
    cell.fit = fit;
    fit();
    input.hidden = true;
    input.after(cell.area, tools);
  }

  // An answer is judged as soon as it has run.
  const withCheck = (number) => {
    const next = cells[number + 1];
    const judged = cells[number].kind === "answer" && next?.kind === "check";
    return judged ? [cells[number], next] : [cells[number]];
  };

  // What the book shows makes room for what the reader's code gives: two figures may share an id.
  function fresh(cell) {
    for (const el of cell.built) {
      const mark = new Comment();
      el.replaceWith(mark);
      cell.away.push([mark, el]);
    }
    cell.built = [];
    emptied(cell);
    cell.error = false;
  }

  function emptied(cell) {
    for (const each of hosts) each.drop(cell.told);
    cell.told.replaceChildren();
  }

  function restore(cell) {
    for (const [mark, el] of cell.away) mark.replaceWith(el);
    cell.built.push(...cell.away.splice(0).map(([, el]) => el));
  }

  function asBuilt() {
    if (remember() && !confirm("Drop your changes and show code and output of the book?")) return;
    for (const cell of cells) {
      restore(cell);
      emptied(cell);
      cell.told.append(...(cell.needs ? [note("torch", cell.needs)] : []));
      if (cell.time) cell.time.textContent = "";
      if (!cell.area) continue;
      cell.area.value = cell.source;
      cell.fit();
    }
    remember();
    stopped("Code and output are the book's again. Python starts afresh.");
  }

  // --- what comes from the worker ---
  function note(kind, text = "") {
    const link = make("a", { href: notebook, download: "" }, "download the notebook");
    const said = {
      torch: [`This cell needs ${text}, not available in the page: `, link, "."],
      twin: ["PyTorch is not available in a page: a small stand-in computes the same with numpy."],
      above: [`This cell needs “${text}” of a cell above that needs PyTorch: `, link, "."],
      after: ["A cell above needs PyTorch and did not run; this may follow: ", link, "."],
      hint: [`Is “${text}” made in a cell above? “Run to here” runs them all.`],
    }[kind];
    return make("p", { class: "live-note" }, ...said);
  }

  function printed(text, kind) {
    const el = make("div", { class: `output stream live-${kind}` }, make("pre", {}, text));
    return el;
  }

  // As MathJax is told to read them on the book's pages.
  const formulas = (text) =>
    text.replaceAll("\\|", "|").replace(/(\$\$?)(.+?)\1/gs, (_, sign, tex) =>
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

  function show(cell, kind, text) {
    const place = cell.told;
    if (kind === "again") return emptied(cell);
    if (kind === "text" || kind === "warning" || kind === "error") {
      const last = place.lastElementChild;
      if (last?.classList.contains(`live-${kind}`)) last.firstChild.append(text);
      else place.append(printed(text, kind));
      return;
    }
    if (kind === "html") {
      const el = make("div", { class: "output text_html" });
      el.innerHTML = text;
      place.append(el);
    } else if (kind === "markdown" || kind === "latex") {
      const plain = kind === "latex" || !text.startsWith("|");
      const el = plain ? make("div", {}, formulas(text)) : table(text);
      el.classList.add("output", "tex2jax_process");
      place.append(el);
      window.MathJax?.typesetPromise?.([el]);
    } else if (kind === "widget") {
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
  let worker, ready, running, waiting, expected, loaded;
  let kept = ""; // what is said while Python starts afresh and nobody waits for it

  function boot() {
    worker = new Worker(new URL("worker.mjs", home), { type: "module" });
    ready = false;
    loaded = 0;
    expected = megabytes[0] * 1e6;
    progress.hidden = false;
    advance(0);
    const mine = worker;
    worker.onmessage = ({ data: message }) => mine === worker && heard(message);
    worker.onerror = (event) => {
      event.preventDefault?.();
      if (mine === worker) heard({ failed: event.message || "its files are not on this site" });
    };
    worker.postMessage({ start: data.map((name) => `data/${name}`) });
  }

  function advance(bytes) {
    loaded += bytes;
    const share = Math.min(100, Math.round((100 * loaded) / expected));
    progress.setAttribute("aria-valuenow", share);
    progress.firstChild.style.inlineSize = `${share}%`;
    const told = `${(loaded / 1e6).toFixed(0)} MB`;
    progress.setAttribute("aria-valuetext", told);
    if (!ready) say(kept || (share < 100 ? "Loading Python …" : "Starting Python …"));
    else if (running) say(`Running ${running.name}: loading what it imports …`);
  }

  function heard(message) {
    if (message.widget) withHost(() => host.heard(message.widget, message.buffers));
    else if (message.bytes) {
      progress.hidden = ready && !running;
      advance(message.bytes);
    } else if (message.ready) {
      ready = true;
      progress.hidden = true;
      expected = megabytes[1] * 1e6;
      say(kept || "Python is ready.");
      next();
    } else if (message.failed) {
      progress.hidden = true;
      waiting = [];
      running?.el.classList.remove("live-running");
      running = undefined;
      ended(); // the next run tries again
      document.documentElement.dataset.live = "idle";
      say(`Python ${ready ? "broke off" : "did not start"}: ${message.failed}.`);
    } else if (message.done) finish(message);
    else if (running && message.run === running.name) {
      if (message.kind === "error") running.error = true;
      if (message.kind === "after") running.error = false; // cells below may do without
      show(running, message.kind, message.text);
    }
  }

  function next() {
    if (!ready || running) return;
    running = waiting.shift();
    if (!running) return;
    fresh(running);
    running.el.classList.add("live-running");
    if (running.time) running.time.textContent = "running …";
    say(`Running ${running.name} of ${cells.length} …`);
    host?.flush();
    worker.postMessage({ run: running.name, source: running.area?.value ?? running.source });
  }

  function finish({ seconds }) {
    const cell = running;
    running = undefined;
    progress.hidden = true;
    cell.el.classList.remove("live-running");
    if (cell.time) cell.time.textContent = `${seconds.toFixed(1)} s`;
    if (cell.error) waiting = [];
    const isOpen = (c) => c.kind === "open";
    const rest = isOpen(cell) && cells.slice(cells.indexOf(cell) + 1).some(isOpen);
    const below = rest ? " Cells below show what they showed before: “Run all”." : "";
    if (!waiting.length)
      say(cell.error ? `An error in ${cell.name}.` : `${cell.name.replace("c", "C")} has run.${below}`);
    document.documentElement.dataset.live = waiting.length ? "running" : "idle";
    next();
  }

  function enqueue(more) {
    document.documentElement.dataset.live = "running";
    kept = "";
    waiting = [...(waiting ?? []), ...more];
    if (!worker) boot();
    next();
  }

  // A worker that computes hears nothing: it is ended, and another one takes its place.
  function stopped(told = "Stopped. Python starts afresh: “Run to here” runs the cells above, too.") {
    ended();
    running?.el.classList.remove("live-running");
    if (running?.time) running.time.textContent = "stopped";
    running = undefined;
    waiting = [];
    kept = told;
    boot();
    document.documentElement.dataset.live = "idle";
  }

  function start() {
    if (location.protocol === "file:") {
      say("");
      status.append(
        "A browser runs Python only in pages that come from a server, not from a folder. In the " +
          "folder of this site run ",
        make("code", {}, "python -m http.server"),
        " and open ",
        make("code", {}, `http://localhost:8000/${location.pathname.split("/").slice(-2).join("/")}`),
        ".",
      );
      return;
    }
    cells.forEach(open);
    begin.replaceWith(all, stop, reset);
    bar.classList.add("live-on");
    bar.after(
      make(
        "p",
        { class: "live-keys", id: "live-keys" },
        "Ctrl+Enter runs a cell. Tab indents after you typed; Escape, then Tab, leaves the code.",
      ),
    );
    all.focus();
    enqueue(cells);
  }
})();
