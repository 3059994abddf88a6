// The answers behind a cell of the stability matrix: for the cell under the pointer, with the focus, or chosen.
"use strict";
(() => {
  const data = window.hausbenchStability, place = document.getElementById("cell");
  const HEAD = ["severity", "tolerance", "outcome", "error / diagonal", "gap / diagonal", "reason"];

  function curve(answers) {
    const points = answers.flatMap(([, severity, tolerance, outcome, error, gap]) => [["error", error], ["gap", gap]]
      .filter(([, value]) => severity > 0 && value > 0).map(([what, value]) => ({severity, value, what: `${what}, tolerance ${tolerance}`, outcome})));
    if (!window.Plot || new Set(points.map((one) => one.severity)).size < 2) return [];
    const made = Plot.plot({width: 640, height: 260, marginLeft: 60, grid: true, color: {legend: true}, style: {background: "var(--paper)", color: "var(--ink)"},
      x: {type: "log", tickFormat: "~g"}, y: {type: "log", label: "fraction of the diagonal of A", tickFormat: "~g"},
      marks: [Plot.line(points, {x: "severity", y: "value", z: "what", stroke: "what"}), Plot.dot(points, {x: "severity", y: "value", z: "what", stroke: "what", tip: true})]});
    return [window.hausbenchFigure(made, "Error and gap at each severity", points)];
  }

  function show(button) {
    const answers = data[Number(button.dataset.place)], table = document.createElement("table");
    window.hausbenchHead(table, HEAD);
    const body = table.createTBody();
    for (const [severity, , tolerance, ...rest] of answers) {
      const row = body.insertRow();
      for (const value of [severity, tolerance, ...rest]) row.insertCell().textContent = value === null ? "—" : String(value);
    }
    const wide = Object.assign(document.createElement("div"), {className: "wide", tabIndex: 0});
    wide.setAttribute("role", "region");
    wide.setAttribute("aria-label", "Answers of the chosen cell");
    wide.append(table);
    place.replaceChildren(Object.assign(document.createElement("h2"), {textContent: button.dataset.title}), ...curve(answers), wide);
  }

  for (const name of ["pointerenter", "focus", "click"]) {
    document.querySelectorAll(".matrix button").forEach((button) => button.addEventListener(name, () => show(button)));
  }
})();
