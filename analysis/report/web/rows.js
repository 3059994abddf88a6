// The table of all rows: filters, pages of 100 rows, and the details of one row. The filters are in the address.
"use strict";
(() => {
  const data = window.hausbenchRows, count = data.lower.length, PAGE = 100;
  const form = document.getElementById("filters"), table = document.getElementById("rows");
  const FILTERS = ["stem", "solver", "status", "tolerance", "scene"];
  const COLUMNS = [["stem", "experiment"], ["scene", "scene"], ["solver", "solver"], ["tolerance", "tolerance"], ["status", "status"],
    ["lower", "lower bound"], ["upper", "upper bound"], ["error", "error / diagonal of A"], ["seconds", "s to prepare and solve"]];
  const DETAILS = [...COLUMNS, ["reason", "reason"], ["check", "lower bound, checked apart"], ["certified", "certified"], ["clock", "clock"],
    ["source", "A"], ["target", "B"], ["pose", "pose"], ["sizeA", "elements of A"], ["sizeB", "elements of B"]];
  let chosen = [], page = 0;

  const value = (column, row) => {
    const values = data[column];
    return Array.isArray(values) ? values[row] : values.values[values.rows[row]];
  };
  const text = (column, row) => {
    const found = value(column, row);
    return found === null || found === "" ? "—" : column === "certified" ? (found === 1 ? "yes" : "no") : String(found);
  };

  function fill() {
    const options = {stem: data.stem.values, solver: data.solver.values, status: data.status.values,
      tolerance: [...new Set(data.tolerance)].filter((x) => x !== null).sort((x, y) => y - x)};
    for (const [name, values] of Object.entries(options)) {
      for (const one of name === "tolerance" ? values : [...values].sort()) form.elements[name].add(new Option(String(one), String(one)));
    }
    window.hausbenchHead(table, COLUMNS.map(([, title]) => title));
  }

  function filter() {
    const tests = [];
    for (const name of ["stem", "solver", "status"]) {
      const wanted = data[name].values.indexOf(form.elements[name].value), rows = data[name].rows;
      if (form.elements[name].value) tests.push((row) => rows[row] === wanted);
    }
    if (form.elements.tolerance.value) {
      const wanted = Number(form.elements.tolerance.value);
      tests.push((row) => data.tolerance[row] === wanted);
    }
    const part = form.elements.scene.value.trim().toLowerCase();
    if (part) {
      const has = data.scene.values.map((name) => name.toLowerCase().includes(part));
      tests.push((row) => has[data.scene.rows[row]]);
    }
    chosen = [];
    for (let row = 0; row < count; row++) if (tests.every((test) => test(row))) chosen.push(row);
    page = 0;
    show();
    window.hausbenchChosen = chosen;
    dispatchEvent(new Event("hausbench-chosen"));
  }

  function show() {
    const from = page * PAGE, part = chosen.slice(from, from + PAGE), body = document.createElement("tbody");
    for (const row of part) {
      const cells = body.insertRow();
      COLUMNS.forEach(([column], i) => {
        const cell = cells.insertCell();
        if (i > 0) { cell.textContent = text(column, row); return; }
        const button = Object.assign(document.createElement("button"), {type: "button", textContent: text(column, row)});
        button.addEventListener("click", () => detail(row));
        cell.append(button);
      });
    }
    table.tBodies[0].replaceWith(body);
    document.getElementById("shown").textContent = `${chosen.length.toLocaleString("en")} of ${count.toLocaleString("en")} rows`;
    document.getElementById("page").textContent = chosen.length ? `${from + 1} to ${from + part.length}` : "no rows";
    document.getElementById("before").disabled = page === 0;
    document.getElementById("after").disabled = from + PAGE >= chosen.length;
  }

  function detail(row) {
    const list = document.createElement("dl");
    for (const [column, title] of DETAILS) {
      list.append(Object.assign(document.createElement("dt"), {textContent: title}), Object.assign(document.createElement("dd"), {textContent: text(column, row)}));
    }
    const place = document.getElementById("row");
    place.replaceChildren(Object.assign(document.createElement("h2"), {textContent: "The chosen row"}), list, ...proof(row));
    place.scrollIntoView({block: "nearest"});
  }

  // How to get a proof of the row's upper bound, and to check it.
  function proof(row) {
    if (!value("prover", row)) return [];
    const words = Object.assign(document.createElement("p"), {textContent: "A proof of the upper bound, and its check:"}), commands = document.createElement("pre");
    commands.textContent = `hausbench measure ${value("source", row)} ${value("target", row)} --solver ${value("prover", row)} --tolerance ${value("tolerance", row)} --certificate row.proof\n`
      + "hausbench verify --certificate row.proof";
    return [words, commands];
  }

  function csv() {
    return window.hausbenchCsv([DETAILS.map(([column]) => column), ...chosen.map((row) => DETAILS.map(([column]) => String(value(column, row) ?? "")))]);
  }

  function read() {
    const asked = new URLSearchParams(location.hash.slice(1));
    for (const name of FILTERS) form.elements[name].value = asked.get(name) ?? "";
    filter();
  }

  function changed() {
    const asked = new URLSearchParams();
    for (const name of FILTERS) if (form.elements[name].value) asked.set(name, form.elements[name].value);
    history.replaceState(null, "", `#${asked}`);
    filter();
  }

  fill();
  read();
  form.addEventListener("input", changed);
  form.addEventListener("submit", (event) => event.preventDefault());
  form.addEventListener("reset", () => setTimeout(changed));
  addEventListener("hashchange", read);
  document.getElementById("before").addEventListener("click", () => { page--; show(); });
  document.getElementById("after").addEventListener("click", () => { page++; show(); });
  document.getElementById("csv").addEventListener("click", (event) => {
    event.currentTarget.href = URL.createObjectURL(new Blob([csv()], {type: "text/csv"}));
  });
})();
