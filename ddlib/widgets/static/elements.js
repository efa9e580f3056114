// Elements of a page, for every widget that draws.

const SVG = "http://www.w3.org/2000/svg";
const SVG_TAGS = new Set(
  "svg g path line text rect circle polygon polyline defs clipPath title".split(" "),
);

// An element with attributes and children, SVG or HTML by its name.
function make(tag, attributes = {}, ...children) {
  const el = SVG_TAGS.has(tag) ? document.createElementNS(SVG, tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) el.setAttribute(name, value);
  el.append(...children);
  return el;
}

// Text in an element; the same text again would lay it out again.
function write(el, text) {
  if (el.textContent !== text) el.textContent = text;
}

// A number for a path, to hundredths of a pixel; quicker than toFixed.
const short = (x) => Math.round(x * 100) / 100;

// Says in place of a figure what is wrong with it.
function report(el, error) {
  el.className = "ddlib-widget-error";
  el.setAttribute("role", "alert");
  el.removeAttribute("aria-label");
  el.textContent = `The data of this interactive figure are damaged: ${error.message}.`;
}

// `build` as a script's `render`.
function safely(build) {
  return ({ model, el }) => {
    try {
      return build({ model, el });
    } catch (error) {
      report(el, error);
    }
  };
}
