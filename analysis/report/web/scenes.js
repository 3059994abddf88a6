// The controls beside the 3-D view: the choice of a scene and of its colours, what is shown, and the slider of a motion.
"use strict";
(() => {
  const data = window.hausbenchScenes, form = document.getElementById("scene"), place = document.getElementById("view");
  if (!window.hausbenchView) {
    document.getElementById("without").hidden = false;
    return;
  }
  const {View, BOUND_NAMES, boundColours, ramp} = window.hausbenchView;
  const chosen = form.elements.scene, by = form.elements.colour, pose = form.elements.pose;
  let view = null;
  data.scenes.forEach((one, k) => chosen.add(new Option(`${one.title} (${one.stem}${one.poses.length > 1 ? ", motion" : ""})`, String(k))));

  const number = (x) => Number(x.toPrecision(7)).toString();
  const atMost = (x) => {  // rounded up
    const near = Number(x.toPrecision(7));
    return (near >= x ? near : Number((near * (1 + 5e-7)).toPrecision(7))).toString();
  };

  function legend(one) {
    const list = document.getElementById("legend"), entries = [];
    if (by.value === "distance" && one.colours.distance) {
      const [low] = one.colours.distance.low, [high] = one.colours.distance.high;
      entries.push([ramp[0], `${number(Math.min(low, 0))} from B`], [ramp[ramp.length - 1], `${number(high)} from B, the largest at a corner shown`]);
    } else if (by.value === "bound" && one.colours.bound) {
      BOUND_NAMES.forEach((name, k) => entries.push([boundColours[k], name]));
    } else {
      entries.push(["#4f6db8", "A"]);
    }
    entries.push(["#999999", "B"]);
    if (one.witness) entries.push(["#d55e00", "witness: the farthest point of A and its nearest point of B"]);
    list.replaceChildren(...entries.map(([colour, text]) => {
      const item = document.createElement("li"), patch = document.createElement("span");
      patch.className = "patch";
      patch.style.background = colour;
      item.append(patch, ` ${text}`);
      return item;
    }));
  }

  function state(one) {
    const k = Number(pose.value), name = one.quantity === "symmetric" ? "H" : "h";
    const where = one.poses.length > 1 ? `pose ${k + 1} of ${one.poses.length}: ` : "";
    document.getElementById("state").textContent = `${where}${name}(A, B) in [${one.lower[k]}, ${one.upper[k]}], by ${one.solver}`;
    const mark = document.getElementById("mark");
    if (mark) mark.setAttribute("transform", `translate(${x(one, k)} 0)`);
  }

  const x = (one, k) => 4 + (592 * k) / Math.max(1, one.poses.length - 1);

  // h(t) and its interval as a small plot, with a mark at the pose that is shown.
  function curve(one) {
    const figure = document.getElementById("curve");
    figure.hidden = one.poses.length < 2;
    if (figure.hidden) return;
    const most = Math.max(...one.upper) || 1, y = (value) => (116 - (112 * value) / most).toFixed(2);
    const line = (values) => values.map((value, k) => `${x(one, k).toFixed(2)},${y(value)}`);
    const band = [...line(one.upper), ...line(one.lower).reverse()].join(" ");
    figure.innerHTML = `<svg viewBox="0 0 600 120" role="img" aria-label="The distance at each pose"><polygon points="${band}" class="band"/>`
      + `<polyline points="${line(one.lower).join(" ")}" class="line"/><line id="mark" y1="0" y2="120" class="mark"/></svg>`;
    figure.append(Object.assign(document.createElement("figcaption"), {textContent: `The interval of the distance at each pose; the greatest is at most ${atMost(most)}.`}));
  }

  function shown() {
    const one = data.scenes[Number(chosen.value)];
    for (const option of by.options) option.disabled = option.value !== "plain" && !one.colours[option.value];
    if (by.selectedOptions[0].disabled) by.value = one.colours.distance ? "distance" : "plain";
    pose.max = String(one.poses.length - 1);
    pose.value = "0";
    document.getElementById("motion").hidden = one.poses.length < 2;
    view.show(Number(chosen.value), by.value);
    parts();
    const sizes = [one.a, one.b].map((k) => data.meshes[k]);
    document.getElementById("sizes").textContent = ["A", "B"].map((name, k) => `${name}: ${sizes[k].of.toLocaleString("en")} triangles`
      + (sizes[k].simplified ? `, simplified to ${sizes[k].count.toLocaleString("en")} for this view alone` : "")).join(". ") + ".";
    legend(one);
    curve(one);
    state(one);
  }

  function parts() {
    view.a.visible = form.elements.showA.checked;
    view.b.visible = form.elements.showB.checked;
    if (view.line) view.line.visible = form.elements.showWitness.checked;
    view.draw();
  }

  function begin() {
    const canvas = document.createElement("canvas");
    Object.assign(canvas, {tabIndex: 0});
    canvas.setAttribute("role", "img");
    canvas.setAttribute("aria-label", "3-D view of A and B. Arrow keys turn it, plus and minus zoom.");
    place.append(canvas);
    try {
      view = new View(canvas, data);
    } catch (problem) {
      canvas.remove();
      document.getElementById("without").hidden = false;
      return;
    }
    const asked = Number(new URLSearchParams(location.hash.slice(1)).get("scene"));
    chosen.value = String(asked < data.scenes.length ? asked : 0);
    window.hausbenchShown = view;
    shown();
    chosen.addEventListener("input", () => { history.replaceState(null, "", `#scene=${chosen.value}`); shown(); });
    by.addEventListener("input", shown);
    pose.addEventListener("input", () => { view.pose(Number(pose.value)); state(view.one); });
    form.addEventListener("change", parts);
    form.addEventListener("submit", (event) => event.preventDefault());
  }

  if (data.scenes.length) {
    new IntersectionObserver((entries, observer) => {
      if (!entries.some((entry) => entry.isIntersecting)) return;
      observer.disconnect();
      begin();
    }).observe(place);
  }
})();
