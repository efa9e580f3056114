// What SpectrumExplorer (spectrum.py) adds to a CurveWidget: a name for its style sheet.

extras.push((view) => {
  view.el.classList.add("ddlib-spectrum");
});
