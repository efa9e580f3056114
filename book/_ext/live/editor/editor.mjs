// The code of a cell in CodeMirror; for the page it is a text field: `value`, `setRangeText`, `input`.
import {
  CompletionContext, acceptCompletion, autocompletion, closeBrackets, closeBracketsKeymap,
  moveCompletionSelection,
} from "@codemirror/autocomplete"; // prettier-ignore
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { globalCompletion, localCompletionSource, pythonLanguage } from "@codemirror/lang-python";
import {
  bracketMatching, ensureSyntaxTree, indentOnInput, indentUnit, syntaxHighlighting, syntaxTree,
} from "@codemirror/language"; // prettier-ignore
import { EditorState } from "@codemirror/state";
import { Decoration, EditorView, keymap } from "@codemirror/view";
import { styleTags, tagHighlighter, tags as t } from "@lezer/highlight";

// --- colours: the classes that the book's pages give to code, so that nothing changes at the click ---
const python = pythonLanguage.configure({
  props: [
    styleTags({
      "FormatSpec FormatSpec/: FormatConversion FormatReplacement/{ FormatReplacement/}": t.string,
      '"*" "**" Ellipsis': t.operator,
      "ImportStatement/.": t.name,
      "Decorator/At Decorator/VariableName": t.meta,
    }),
  ],
});
const colours = tagHighlighter([
  { tag: [t.keyword, t.bool, t.null], class: "k" },
  { tag: t.comment, class: "c1" },
  { tag: [t.string, t.escape], class: "s2" },
  { tag: t.number, class: "mi" },
  { tag: t.operator, class: "o" },
  { tag: t.function(t.definition(t.variableName)), class: "nf" },
  { tag: t.definition(t.className), class: "nc" },
  { tag: t.meta, class: "nd" },
]);
// Names of Python itself; its list has templates of statements, too.
const every = globalCompletion(new CompletionContext(EditorState.create(), 0, true)).options;
const builtin = every.filter(({ apply, label }) => !apply && !label.startsWith("_"));
const drawn = new Map(builtin.map(({ label, type }) => [label, type === "type" ? "ne" : "nb"]));
drawn.set("self", "bp");
const builtins = EditorView.decorations.compute(["doc"], (state) => {
  const marks = [];
  ensureSyntaxTree(state, state.doc.length, 1000)?.iterate({
    enter({ name, from, to }) {
      const kind = name === "VariableName" && drawn.get(state.sliceDoc(from, to));
      if (kind) marks.push(Decoration.mark({ class: kind }).range(from, to));
    },
  });
  return Decoration.set(marks);
});

// --- names that exist: of the cells above, of this one, of Python; of an object, what it has ---
const offered = (page) => async (context) => {
  const { pos, state, explicit } = context;
  if (/String|Comment/.test(syntaxTree(state).resolveInner(pos, -1).name)) return null;
  const line = state.doc.lineAt(pos);
  const before = line.text.slice(0, pos - line.from);
  const [word] = /\w*$/.exec(before);
  const list = (options) => ({ from: pos - word.length, options, validFor: /^\w*$/ });
  const imported = /^\s*from\s+([\w.]+)\s+import\s(?:.*[\s,(])?\w*$/.exec(before);
  const dotted = /(?<![\w.)\]}"'])([^\W\d]\w*(?:\.\w+)*)\.\w*$/.exec(before);
  const asked = imported ?? dotted;
  if (asked) return list((await page.parts(asked[1], Boolean(imported))).map((label) => ({ label })));
  if (/\.\w*$|(?<!\w)\d\w*$/.test(before) || !(explicit || word.length > 1)) return null;
  const names = new Map(builtin.map((option) => [option.label, option]));
  for (const [label, detail] of page.names()) names.set(label, { label, detail, boost: 1 });
  for (const { label } of localCompletionSource(context)?.options ?? [])
    if (label !== word) names.set(label, { label, boost: 2 });
  return list([...names.values()]);
};
const take = (view) =>
  acceptCompletion(view) || (moveCompletionSelection(true)(view) && acceptCompletion(view));

// --- look: letters as on the page; what is loaded before the click knows nothing of this ---
const look = EditorView.theme({
  "&.live-code.highlight": { background: "var(--pst-color-surface)", padding: 0 },
  "&.cm-focused": { outline: "2px solid var(--pst-color-primary)", outlineOffset: "1px" },
  ".cm-scroller": { fontFamily: "inherit", lineHeight: "inherit" },
  ".cm-content": {
    caretColor: "var(--pst-color-text-base)",
    padding: "0.6rem 1rem 0.6rem calc(1rem - 2px)",
    scrollMarginBlock: "9rem 3rem",
  },
  ".cm-line": { padding: 0 },
  "&.cm-focused .cm-matchingBracket": {
    background: "none",
    outline: "1px solid var(--pst-color-text-muted)",
  },
  ".cm-tooltip": {
    background: "var(--pst-color-background)",
    border: "1px solid var(--pst-color-text-muted)",
    color: "var(--pst-color-text-base)",
  },
  ".cm-tooltip.cm-tooltip-autocomplete > ul": { fontFamily: "inherit", maxHeight: "10em" },
  ".cm-tooltip.cm-tooltip-autocomplete > ul > li": { lineHeight: 1.5, padding: "0 0.5em" },
  ".cm-tooltip.cm-tooltip-autocomplete > ul > li[aria-selected]": {
    background: "var(--pst-color-primary)",
    color: "var(--pst-color-primary-text)",
  },
  ".cm-completionMatchedText": { fontWeight: 600, textDecoration: "none" },
  ".cm-completionDetail": { fontStyle: "normal" },
  "@media print": { ".cm-content": { whiteSpace: "pre-wrap" } },
});

// `page.names()` are pairs of a name and whence it comes; `page.parts(path, isModule)` promises names.
export function editor(attributes, page) {
  const moved = "input.type.handle"; // one step back undoes one drag
  const written = ({ docChanged, transactions, view }) => {
    if (!docChanged || transactions.some((each) => each.isUserEvent(moved))) return;
    view.setTabFocusMode(false);
    view.dom.dispatchEvent(new Event("input"));
  };
  const { class: name, ...own } = attributes;
  const extensions = [
    // Tab leaves a cell that is passed through, and after Escape: nobody is trapped.
    EditorView.domEventHandlers({
      focus: (_, view) => view.setTabFocusMode(true),
      click: (_, view) => view.setTabFocusMode(false),
      keydown: ({ key }, view) => void (key === "Escape" && view.setTabFocusMode(true)),
    }),
    keymap.of([{ key: "Tab", run: take }, ...closeBracketsKeymap, ...historyKeymap, indentWithTab]),
    keymap.of(defaultKeymap),
    history(),
    python,
    indentUnit.of("    "),
    indentOnInput(),
    bracketMatching(),
    closeBrackets(),
    autocompletion({
      override: [offered(page)], filterStrict: true, icons: false, selectOnOpen: false,
    }), // prettier-ignore
    syntaxHighlighting(colours),
    builtins,
    look,
    EditorView.editorAttributes.of({ class: `${name} highlight` }),
    EditorView.contentAttributes.of({ ...own, class: "n", tabindex: "0" }), // a place to scroll from
    // what is typed is not behind the header and the handles
    EditorView.scrollHandler.of((_, __, how) => void Object.assign(how, { xMargin: 14, yMargin: 144 })),
    EditorView.updateListener.of(written),
  ];
  const view = new EditorView();
  Object.defineProperty(view.dom, "value", {
    get: () => view.state.doc.toString(),
    set: (doc) => view.setState(EditorState.create({ doc, extensions })), // there is no way back
  });
  view.dom.setRangeText = (insert, from, to) =>
    view.dispatch({ changes: { from, to, insert }, userEvent: moved });
  view.dom.value = "";
  // A letter is written here, whatever it means to the page: "/" would open its search.
  view.dom.addEventListener("keydown", (event) => {
    if (event.key.length === 1 && !event.ctrlKey && !event.metaKey) event.stopPropagation();
  });
  return view.dom;
}
