"use strict";
(() => {
  const film = JSON.parse(document.getElementById("film").textContent);
  const byId = (id) => document.getElementById(id);
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  for (const item of document.querySelectorAll(".live")) item.hidden = false;
  addEventListener("beforeprint", () => document.querySelectorAll("details").forEach((item) => { item.open = true; }));

  /* Frames: tables of 16-bit steps and 32-bit floats, item by item. */
  const bytes = (text) => Uint8Array.from(atob(text), (sign) => sign.charCodeAt(0)).buffer;
  const steps = (table) => ({ ...table, data: new Int16Array(bytes(table.data)) });
  const opened = new Map();
  function open(window) {
    if (!opened.has(window.name)) {
      opened.set(window.name, {
        ...window, phi: new Float64Array(bytes(window.phi)), twist: steps(window.twist), dx: steps(window.dx),
        dy: steps(window.dy), force: new Float32Array(bytes(window.force)), touching: new Uint8Array(bytes(window.touching)),
      });
    }
    return opened.get(window.name);
  }
  let shown = open(film.windows[0]), frame = 0, place = 0, factor = film.factor, chosen = film.chosen ?? undefined;
  const index = (names) => new Map(names.map((name, k) => [name, k]));
  const rotors = index(film.rotors), bodies = index(film.bodies), meshes = index(film.meshes);
  const read = (table, k, i) => table.middle[k] + table.step[k] * table.data[k * shown.count + i];
  const timeAt = (i) => shown.count > 1 ? shown.time[0] + (shown.time[1] - shown.time[0]) * i / (shown.count - 1) : shown.time[0];
  const forceAt = (k, i) => shown.force[k * shown.count + i];
  function angle(name, i) {
    const k = rotors.get(name);
    return k === undefined ? 0 : shown.start[k] + film.ratio[k] * shown.phi[i] + read(shown.twist, k, i);
  }
  function shift(name, i) {
    const k = bodies.get(name);
    return k === undefined ? [0, 0] : [factor * read(shown.dx, k, i), factor * read(shown.dy, k, i)];
  }

  /* What moves on the page. */
  const panels = film.panels.map((panel, k) => {
    const root = document.querySelector(`[data-panel="${k}"]`);
    const contacts = [...root.querySelectorAll("g.contact")];
    return { ...panel, groups: [...root.querySelectorAll("g.wheel")], marks: contacts,
             arrows: contacts.map((item) => item.querySelector(".push")) };
  });
  const buttons = new Map([...document.querySelectorAll("button[data-mesh]")].map((item) => [item.dataset.mesh, item]));
  const outputs = new Map([...buttons].map(([name, item]) => [name, item.querySelector("output")]));
  const units = new Map(film.panels.flatMap((panel) => panel.contacts.map((mesh) => [mesh.name, panel.measure])));
  const tell = (name, force) => `${(force / units.get(name)[1]).toPrecision(4)} ${units.get(name)[0]}`;
  const set = (group, x, y, turn) =>
    group.setAttribute("transform", `translate(${x.toFixed(2)} ${(-y).toFixed(2)}) rotate(${(-turn * 180 / Math.PI % 360).toFixed(2)})`);
  function arrow(length) {
    const head = Math.min(film.head, Math.abs(length)) * (length < 0 ? -1 : 1), half = Math.abs(head) * 0.42;
    return `M0 0H${(length - head).toFixed(2)}M${length.toFixed(2)} 0l${(-head).toFixed(2)} ${(-half).toFixed(2)}v${(2 * half).toFixed(2)}z`;
  }
  function pose(i) {
    for (const panel of panels) {
      const turn = angle(panel.frame, i), c = Math.cos(turn) * panel.scale, s = Math.sin(turn) * panel.scale;
      const put = (group, x, y, about) => set(group, c * x - s * y, s * x + c * y, about);
      panel.wheels.forEach((wheel, k) => {
        const [dx, dy] = shift(wheel.body, i);
        put(panel.groups[k], wheel.x + dx, wheel.y + dy, angle(wheel.body, i));
      });
      panel.contacts.forEach((mesh, k) => {
        const one = shift(mesh.one, i), two = shift(mesh.two, i), m = meshes.get(mesh.name), force = forceAt(m, i);
        put(panel.marks[k], mesh.x + (one[0] + two[0]) / 2, mesh.y + (one[1] + two[1]) / 2, turn + mesh.direction);
        panel.arrows[k].setAttribute("d", arrow(panel.unit ? force / panel.unit * film.longest : 0));
        panel.marks[k].classList.toggle("open", !shown.touching[m * shown.count + i] || force === 0);
        outputs.get(mesh.name).value = tell(mesh.name, force);
      });
    }
  }

  /* The strip: the selected mesh's force over the window. */
  const strip = byId("strip");
  function trace() {
    if (!strip || chosen === undefined) return;
    const k = meshes.get(chosen), forces = shown.force.subarray(k * shown.count, (k + 1) * shown.count);
    let low = Math.min(...forces), high = Math.max(...forces);
    byId("range").value = `Curve: ${tell(chosen, low)} to ${tell(chosen, high)}.`;
    if (low === high) { low -= 1; high += 1; }
    const room = 0.08 * (high - low), y = (force) => 100 * (high + room - force) / (high - low + 2 * room);
    const points = Array.from(forces, (force, i) => `${i} ${y(force).toFixed(2)}`);
    strip.setAttribute("viewBox", `0 0 ${Math.max(1, shown.count - 1)} 100`);
    strip.querySelector("path").setAttribute("d", "M" + points.join("L"));
    const zero = strip.querySelector(".zero");
    for (const [key, value] of [["x1", 0], ["x2", shown.count - 1], ["y1", y(0)], ["y2", y(0)]]) zero.setAttribute(key, value);
  }

  /* Cursors in pictures over time. */
  const clocks = [...document.querySelectorAll("[data-clocks]")].flatMap((figure) =>
    JSON.parse(figure.dataset.clocks).map((axes) => {
      const line = document.createElementNS("http://www.w3.org/2000/svg", "line");
      line.setAttribute("class", "cursor");
      line.setAttribute("y1", axes.top);
      line.setAttribute("y2", axes.bottom);
      figure.querySelector("svg").append(line);
      return { ...axes, line };
    }));
  function point(time) {
    for (const { left, right, begin, end, line } of clocks) {
      const inside = time >= begin && time <= end, x = left + (right - left) * (time - begin) / (end - begin);
      line.style.visibility = inside ? "" : "hidden";
      if (inside) { line.setAttribute("x1", x.toFixed(2)); line.setAttribute("x2", x.toFixed(2)); }
    }
  }

  const scrub = byId("scrub"), play = byId("play"), slow = byId("slow"), span = byId("span"), grow = byId("grow");
  function show() {
    const time = timeAt(frame);
    pose(frame);
    point(time);
    scrub.value = frame;
    scrub.setAttribute("aria-valuetext", `${time.toFixed(6)} s`);
    byId("time").value = `${time.toFixed(6)} s`;
    if (chosen !== undefined) {
      const force = forceAt(meshes.get(chosen), frame), [unit, size] = units.get(chosen);
      byId("force").value = `${(force / size).toPrecision(6)} ${unit}`;
      byId("chosen").value = chosen;
      const cursor = strip.querySelector("line:not(.zero)");
      cursor.setAttribute("x1", frame);
      cursor.setAttribute("x2", frame);
    }
  }
  function go(i) { place = frame = Math.max(0, Math.min(shown.count - 1, Math.round(i))); show(); }
  function select(name) {
    if (!meshes.has(name)) return;
    chosen = name;
    for (const [key, item] of buttons) item.setAttribute("aria-pressed", key === name);
    for (const panel of panels) for (const item of panel.marks) item.classList.toggle("on", item.dataset.mesh === name);
    trace();
    show();
  }
  function change(name) {
    const time = timeAt(frame);
    shown = open(film.windows.find((item) => item.name === name));
    scrub.max = shown.count - 1;
    slow.value = shown.pace;
    const [begin, end] = shown.time;
    trace();
    go(end > begin && time >= begin && time <= end ? (time - begin) / (end - begin) * (shown.count - 1) : 0);
  }

  /* Playing: simulated seconds pass at the pace that is chosen; out of sight nothing moves. */
  let playing = false, last = 0, seen = true;
  const stage = byId("stage");
  new IntersectionObserver((entries) => { seen = entries.at(-1).isIntersecting; }).observe(stage);
  function tick(now) {
    if (playing && seen && !document.hidden && shown.count > 1) {
      const frames = (shown.count - 1) / (shown.time[1] - shown.time[0]);
      place = (place + Math.min(now - last, 200) / 1000 * Number(slow.value) * frames) % shown.count;
      if (Math.floor(place) !== frame) { frame = Math.floor(place); show(); }
    }
    last = now;
    requestAnimationFrame(tick);
  }
  function run(wanted) {
    playing = wanted;
    play.textContent = playing ? "Pause" : "Play";
    play.setAttribute("aria-pressed", playing);
  }
  play.onclick = () => run(!playing);
  scrub.oninput = () => { run(false); go(Number(scrub.value)); };
  span.onchange = () => change(span.value);
  if (grow) grow.oninput = () => { factor = film.factor * Number(grow.value); byId("factor").value = `× ${Number(factor.toPrecision(3))}`; show(); };
  for (const [name, item] of buttons) item.onclick = () => select(name);
  for (const panel of panels) for (const item of panel.marks) item.onclick = () => select(item.dataset.mesh);
  function pick(event) {
    const box = strip.getBoundingClientRect();
    run(false);
    go((event.clientX - box.left) / box.width * (shown.count - 1));
  }
  if (strip) {
    strip.onpointerdown = (event) => { strip.setPointerCapture(event.pointerId); pick(event); };
    strip.onpointermove = (event) => { if (event.buttons) pick(event); };
  }
  stage.onkeydown = (event) => {
    const far = event.shiftKey ? 10 : 1;
    const moves = { ArrowLeft: frame - far, ArrowRight: frame + far, Home: 0, End: shown.count - 1 };
    const own = event.target.matches("select, button, input:not(#scrub)");
    if (event.key === " " && !event.target.matches("select, button")) run(!playing);
    else if (event.key in moves && !own) { run(false); go(moves[event.key]); }
    else return;
    event.preventDefault();
  };

  /* Mode shapes: all at one pace. */
  const parts = [...document.querySelectorAll("g[data-m]")].map((group) => [group, JSON.parse(group.dataset.m)]);
  const move = byId("move"), modes = byId("modes");
  let moving = !still, turned = 0, before = 0, visible = false;
  if (move && parts.length) {
    new IntersectionObserver((entries) => { visible = entries.at(-1).isIntersecting; }).observe(modes);
    const label = () => { move.textContent = moving ? "Stop" : "Move"; };
    move.onclick = () => { moving = !moving; label(); };
    label();
    const sway = (now) => {
      if (moving && visible) {
        turned += Math.min(now - before, 200) / 1000 * 3;
        const c = Math.cos(turned), s = Math.sin(turned), at = (v) => (v[0] * c - v[1] * s).toFixed(2);
        for (const [group, [x, y, turn, cx, cy]] of parts)
          group.setAttribute("transform", `translate(${at(x)} ${at(y)}) rotate(${at(turn)} ${cx} ${cy})`);
      }
      before = now;
      requestAnimationFrame(sway);
    };
    requestAnimationFrame(sway);
  }

  change(film.windows[0].name);
  if (chosen !== undefined) select(chosen);
  run(!still && shown.count > 1);
  requestAnimationFrame(tick);
})();
