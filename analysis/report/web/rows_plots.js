// Plots of the rows that the filters chose, drawn with Plot as SVG: when they are first scrolled to, and again after each change.
"use strict";
(() => {
  const data = window.hausbenchRows, form = document.getElementById("plot"), section = document.getElementById("plotted");
  const field = (name) => form.elements[name].value;
  const text = (column, row) => data[column].values[data[column].rows[row]];
  // A case is one question; each solver has at most one row for it.
  const caseOf = (row) => [text("stem", row), text("scene", row), data.tolerance[row], data.pose[row]].join("\t");
  const title = (row) => `${text("scene", row)}\n${text("stem", row)}, tolerance ${data.tolerance[row]}`;
  const WIDTH = 900, HEIGHT = 480, ASIDE = {width: WIDTH, height: HEIGHT, marginLeft: 70, grid: true, style: {background: "var(--paper)", color: "var(--ink)"}};
  let visible = false, waiting = 0, points = [];
  section.hidden = false;

  const solved = (rows) => rows.filter((row) => text("status", row) === "ok" && data.seconds[row] > 0);

  function bySolver(rows) {
    const found = new Map();
    for (const row of rows) {
      const name = text("solver", row);
      if (!found.has(name)) found.set(name, []);
      found.get(name).push(row);
    }
    return found;
  }

  function least(rows) {
    const found = new Map();
    for (const row of rows) found.set(caseOf(row), Math.min(found.get(caseOf(row)) ?? Infinity, data.seconds[row]));
    return found;
  }

  function drawSolved(rows) {
    const relative = Boolean(field("relative")), first = least(solved(rows));
    points = [];
    for (const [solver, own] of bySolver(rows)) {
      const times = solved(own).map((row) => (relative ? data.seconds[row] / first.get(caseOf(row)) : data.seconds[row])).sort((x, y) => x - y);
      times.forEach((seconds, k) => points.push({solver, seconds, solved: k + 1}));
    }
    const x = relative ? "times as long as the fastest" : "time to prepare and solve (s)";
    return [Plot.plot({...ASIDE, color: {legend: true}, x: {type: "log", label: x, tickFormat: "~g"}, y: {label: "cases solved"},
      marks: [Plot.lineY(points, {x: "seconds", y: "solved", stroke: "solver", curve: "step-after"}), Plot.tip(points, Plot.pointer({x: "seconds", y: "solved", title: (d) => `${d.solver}: ${d.solved} cases within ${d.seconds}`}))]}),
    "A line ends where the solver solved no more cases. Solvers that were asked for different cases cannot be compared: choose an experiment."];
  }

  function drawScatter(rows) {
    const across = new Map(solved(rows).filter((row) => text("solver", row) === field("x")).map((row) => [caseOf(row), row]));
    const relative = Boolean(field("relative"));
    points = solved(rows).filter((row) => text("solver", row) === field("y") && across.has(caseOf(row))).map((row) => {
      const x = data.seconds[across.get(caseOf(row))], y = data.seconds[row];
      return {x, y: relative ? y / x : y, experiment: text("stem", row), scene: text("scene", row), tolerance: data.tolerance[row], title: title(row)};
    });
    const line = relative ? Plot.ruleY([1]) : Plot.line([Math.min(...points.map((d) => d.x)), Math.max(...points.map((d) => d.x))], {x: (d) => d, y: (d) => d});
    return [Plot.plot({...ASIDE, color: {legend: true}, x: {type: "log", label: `${field("x")} (s)`, tickFormat: "~g"}, y: {type: "log", tickFormat: "~g", label: relative ? `${field("y")} / ${field("x")}` : `${field("y")} (s)`},
      marks: points.length ? [line, Plot.dot(points, {x: "x", y: "y", stroke: "experiment"}), Plot.tip(points, Plot.pointer({x: "x", y: "y", title: "title"}))] : []}),
    `${points.length} cases that both solved. Below the line, the solver that goes up is faster.`];
  }

  function drawError(rows) {
    const known = rows.filter((row) => data.error[row] > 0 && data.seconds[row] > 0), first = least(known), relative = Boolean(field("relative"));
    points = known.map((row) => ({x: relative ? data.seconds[row] / first.get(caseOf(row)) : data.seconds[row], error: data.error[row], solver: text("solver", row), title: `${text("solver", row)}\n${title(row)}`}));
    return [Plot.plot({...ASIDE, color: {legend: true}, x: {type: "log", label: relative ? "times as long as the fastest" : "time to prepare and solve (s)", tickFormat: "~g"}, y: {type: "log", label: "error / diagonal of A", tickFormat: "~g"}, symbol: {legend: true},
      marks: [Plot.dot(points, {x: "x", y: "error", stroke: "solver", symbol: "solver"}), Plot.tip(points, Plot.pointer({x: "x", y: "error", title: "title"}))]}),
    "Rows whose error is 0 or unknown are left out."];
  }

  function fill(rows) {
    const names = [...bySolver(rows).keys()].sort();
    for (const [name, usual] of [["x", 0], ["y", 1]]) {
      const select = form.elements[name], before = select.value;
      select.replaceChildren(...names.map((one) => new Option(one, one)));
      select.value = names.includes(before) ? before : names[Math.min(usual, names.length - 1)] ?? "";
    }
    const two = field("kind") === "scatter";
    for (const id of ["across", "up"]) document.getElementById(id).hidden = !two;
  }

  function draw() {
    waiting = 0;
    const rows = window.hausbenchChosen ?? [];
    fill(rows);
    const [made, note] = {solved: drawSolved, scatter: drawScatter, error: drawError}[field("kind")](rows);
    document.getElementById("figure").replaceChildren(window.hausbenchFigure(made, form.elements.kind.selectedOptions[0].textContent, points));
    document.getElementById("plot-note").textContent = points.length ? note : "No row has what this plot needs.";
  }

  function changed() {
    if (visible && !waiting) waiting = setTimeout(draw, 50);
  }

  addEventListener("hausbench-chosen", changed);
  form.addEventListener("input", changed);
  form.addEventListener("submit", (event) => event.preventDefault());
  new IntersectionObserver((entries) => {
    visible ||= entries.some((entry) => entry.isIntersecting);
    changed();
  }).observe(section);
})();
