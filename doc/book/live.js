// The live figures: reads the controls, lets the program (live-program.js, WebAssembly) evaluate, and draws what it
// answers. Whatever is physics or a number to read is made by the program; here are only places on the screen.
"use strict";
(() => {
  const SVG = "http://www.w3.org/2000/svg";
  const make = (tag, attributes = {}, ...children) => {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.append(...children);
    return element;
  };
  const svg = (tag, attributes = {}, text = "") => {
    const element = document.createElementNS(SVG, tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.textContent = text;
    return element;
  };
  const place = (value) => Number(value.toFixed(2));
  const minus = (words) => String(words).replaceAll("-", "−");
  const path = (points) => points.map(([x, y], i) => `${i ? "L" : "M"}${place(x)} ${place(y)}`).join("");

  // ---------------------------------------------------------------- the program
  class Program {
    constructor(module) {
      this.module = module;
      this.buffer = module._malloc(16 * 8);
      this.figures = JSON.parse(module.UTF8ToString(module._malusLiveFigures()));
    }
    evaluate(figure, values) {
      this.module.HEAPF64.set(values, this.buffer / 8);
      const answer = JSON.parse(this.module.UTF8ToString(this.module._malusLiveEvaluate(this.figures.indexOf(figure), this.buffer)));
      if (answer.error) return answer;
      answer.curve = {};
      for (const { name, at, count } of answer.curves) answer.curve[name] = this.module.HEAPF64.subarray(at / 8, at / 8 + count);
      return answer;
    }
  }

  // ---------------------------------------------------------------- drawing
  // round steps for an axis
  const ticks = (least, most, about = 5) => {
    const rough = (most - least) / about, power = 10 ** Math.floor(Math.log10(rough));
    const step = [1, 2, 5, 10].map((factor) => factor * power).find((one) => one >= rough * 0.999);
    const out = [];
    for (let i = Math.ceil(least / step - 1e-9); i * step <= most + 1e-9 * step; ++i) out.push(Number((i * step).toPrecision(12)));
    return out;
  };

  class Drawing {
    constructor(width, height) {
      this.svg = svg("svg", { viewBox: `0 0 ${width} ${height}`, class: "live-drawing" });
      this.svg.style.maxWidth = `${width}px`;
    }
    add(tag, attributes, text) {
      const element = svg(tag, attributes, text);
      this.svg.append(element);
      return element;
    }
    line(points, kind) { return this.add("path", { d: path(points), class: `line ${kind}` }); }
    text(x, y, words, attributes = {}) { return this.add("text", { x: place(x), y: place(y), ...attributes }, words); }
    dot(x, y, kind = "here", r = 5) { return this.add("circle", { cx: place(x), cy: place(y), r, class: kind }); }
  }

  // a frame with axes in a drawing of its own, narrow on a phone; to(x, y) is the place of a point
  class Plot {
    constructor(narrow, { height = 250, x, y, xLabel, yLabel, xTicks, legend = [] }) {
      const above = narrow && legend.length ? 30 : 14, right = narrow ? 12 : legend.length ? 104 : 16;
      Object.assign(this, { left: 58, top: above, width: (narrow ? 350 : 640) - 58 - right, height, x, y });
      const { left, top, width } = this, drawing = this.drawing = new Drawing(left + width + right, top + height + 48);
      drawing.add("rect", { x: left, y: top, width, height, class: "frame" });
      for (const at of xTicks || ticks(...x, narrow ? 4 : 7)) {
        const [px] = this.to(at, y[0]);
        drawing.line([[px, top + height], [px, top + height - 5]], "axis");
        drawing.text(px, top + height + 18, minus(at), { "text-anchor": "middle" });
      }
      for (const at of ticks(...y)) {
        const [, py] = this.to(x[0], at);
        drawing.line([[left, py], [left + width, py]], "grid");
        drawing.text(left - 8, py + 4.5, minus(at), { "text-anchor": "end" });
      }
      drawing.text(left + width / 2, top + height + 40, xLabel, { "text-anchor": "middle" });
      drawing.text(14, top + height / 2, yLabel, { "text-anchor": "middle", transform: `rotate(-90 14 ${top + height / 2})` });
      legend.forEach(([kind, words], i) => {
        const at = narrow ? [left + i * width / legend.length, 13] : [left + width + 12, top + 12 + 22 * i];
        drawing.line([at, [at[0] + 22, at[1]]], kind);
        drawing.text(at[0] + 28, at[1] + 4.5, words);
      });
    }
    to(x, y) {
      return [this.left + (x - this.x[0]) / (this.x[1] - this.x[0]) * this.width,
        this.top + (this.y[1] - y) / (this.y[1] - this.y[0]) * this.height];
    }
    curve(xs, ys, kind) {
      const inside = (y) => Math.min(Math.max(y, this.y[0]), this.y[1]);
      this.drawing.line(Array.from(xs, (x, i) => this.to(x, inside(ys[i]))), kind);
    }
    upright(x, kind = "mark") { this.drawing.line([this.to(x, this.y[0]), this.to(x, this.y[1])], kind); }
    dot(x, y) { this.drawing.dot(...this.to(x, y)); }
  }

  // an ellipse in a square frame; an arrow tells which way the tip turns
  const ellipse = (drawing, left, top, side, xs, ys, words) => {
    const half = side / 2, scale = half * 0.88, at = (i) => [left + half + scale * xs[i], top + half - scale * ys[i]];
    drawing.add("rect", { x: left, y: top, width: side, height: side, class: "frame" });
    drawing.line([[left, top + half], [left + side, top + half]], "grid");
    drawing.line([[left + half, top], [left + half, top + side]], "grid");
    drawing.line(Array.from(xs, (_, i) => at(i)), "first");
    const [[x0, y0], [x1, y1]] = [at(8), at(10)], length = Math.hypot(x1 - x0, y1 - y0);
    if (length > 0.5 && Math.abs(xs[0] * ys[18] - ys[0] * xs[18]) > 0.02) {
      const [dx, dy] = [(x1 - x0) / length * 7, (y1 - y0) / length * 7];
      drawing.line([[x1 - dx - dy * 0.6, y1 - dy + dx * 0.6], [x1, y1], [x1 - dx + dy * 0.6, y1 - dy - dx * 0.6]], "first");
    }
    drawing.text(left + half, top + side + 18, words, { "text-anchor": "middle" });
  };

  // the sphere of radius 1 seen from outside; S3 points up
  const sphere = ([s1, s2, s3]) => {
    const drawing = new Drawing(290, 290), [ca, sa] = [Math.cos(0.6), Math.sin(0.6)], [ce, se] = [Math.cos(0.35), Math.sin(0.35)];
    const to = (x, y, z) => [145 + 105 * (y * ca - x * sa), 140 - 105 * (z * ce - (x * ca + y * sa) * se)];
    const near = (x, y, z) => (x * ca + y * sa) * ce + z * se >= 0;
    const circle = (at) => {
      for (const side of [true, false]) {
        let run = [];
        for (let i = 0; i <= 120; ++i) {
          const point = at(Math.cos(i * Math.PI / 60), Math.sin(i * Math.PI / 60));
          if (near(...point) === side) run.push(to(...point));
          if (run.length && (near(...point) !== side || i === 120)) { drawing.line(run, side ? "axis" : "grid"); run = []; }
        }
      }
    };
    drawing.add("circle", { cx: 145, cy: 140, r: 105, class: "frame" });
    for (const at of [(c, s) => [c, s, 0], (c, s) => [c, 0, s], (c, s) => [0, c, s]]) circle(at);
    for (const [words, x, y, z] of [["S1", 1, 0, 0], ["S2", 0, 1, 0], ["S3", 0, 0, 1]]) {
      drawing.line([to(0, 0, 0), to(x * 1.15, y * 1.15, z * 1.15)], "axis");
      const [px, py] = to(x * 1.29, y * 1.29, z * 1.29);
      drawing.text(px, py + 5, words, { "text-anchor": "middle" });
    }
    drawing.line([to(0, 0, 0), to(s1, s2, 0), to(s1, s2, s3)], "mark");
    drawing.line([to(0, 0, 0), to(s1, s2, s3)], "second");
    drawing.dot(...to(s1, s2, s3), near(s1, s2, s3) ? "here" : "behind");
    return drawing.svg;
  };

  // colours between some of the map viridis, and a circle of hues for angles
  const viridis = [[68, 1, 84], [71, 45, 123], [59, 82, 139], [44, 114, 142], [33, 145, 140], [40, 174, 128], [94, 201, 98], [173, 220, 48], [253, 231, 37]];
  const circle = [[226, 217, 226], [110, 144, 192], [94, 67, 165], [47, 20, 54], [134, 38, 79], [192, 100, 80], [226, 217, 226]];
  const colour = (part, cyclic) => {
    const map = cyclic ? circle : viridis, at = Math.min(Math.max(part, 0), 1) * (map.length - 1), i = Math.min(Math.floor(at), map.length - 2);
    return map[i].map((low, k) => Math.round(low + (at - i) * (map[i + 1][k] - low)));
  };
  const shades = [false, true].map((cyclic) => Uint32Array.from({ length: 256 }, (_, i) => {
    const [red, green, blue] = colour(i / 255, cyclic);
    return (255 << 24 | blue << 16 | green << 8 | red) >>> 0;
  }));
  // a disk of values on rings and azimuths; the cell of each pixel is found once
  class Disk {
    constructor(size, rings, azimuths) {
      this.canvas = make("canvas", { width: size, height: size });
      this.context = this.canvas.getContext("2d");
      this.image = this.context.createImageData(size, size);
      this.pixels = new Uint32Array(this.image.data.buffer);
      this.cells = new Int32Array(size * size).fill(-1);
      for (let y = 0; y < size; ++y)
        for (let x = 0; x < size; ++x) {
          const right = (x + 0.5) / size * 2 - 1, down = (y + 0.5) / size * 2 - 1, r = Math.hypot(right, down);
          if (r > 1) continue;
          const turn = Math.atan2(-right, down) / (2 * Math.PI);
          this.cells[y * size + x] = Math.round(r * (rings - 1)) * azimuths + Math.round((turn + 1) * azimuths) % azimuths;
        }
    }
    paint(values, most, cyclic) {
      const { cells, pixels } = this, shade = shades[Number(cyclic)];
      const tone = Uint32Array.from(values, (value) => shade[Math.round(Math.min(value / most, 1) * 255)]);
      for (let i = 0; i < cells.length; ++i) if (cells[i] >= 0) pixels[i] = tone[cells[i]];
      this.context.putImageData(this.image, 0, 0);
      return this.canvas;
    }
  }
  // what the colours mean
  const scaleOf = (most, cyclic, words) => {
    const drawing = new Drawing(110, 306);
    const inside = drawing.add("foreignObject", { x: 20, y: 20, width: 18, height: 270 }), strip = make("canvas", { width: 1, height: 256 });
    const context = strip.getContext("2d"), image = context.createImageData(1, 256);
    new Uint32Array(image.data.buffer).set(Array.from(shades[Number(cyclic)]).reverse());
    context.putImageData(image, 0, 0);
    inside.append(strip);
    drawing.add("rect", { x: 20, y: 20, width: 18, height: 270, class: "frame" });
    for (const at of cyclic ? [0, 45, 90, 135, 180] : ticks(0, most)) drawing.text(46, 290 - 270 * at / most + 4.5, String(at));
    drawing.text(110, 155, words, { "text-anchor": "middle", transform: "rotate(-90 103 155)" });
    return drawing.svg;
  };

  // ---------------------------------------------------------------- the figures
  const draw = {
    stokes({ curve }) {
      const drawing = new Drawing(290, 290);
      ellipse(drawing, 20, 15, 250, curve.x, curve.y, "");
      drawing.text(262, 132, "x"), drawing.text(152, 30, "y");
      return [drawing.svg, sphere(curve.point)];
    },
    chain({ curve }, value, narrow) {
      const side = narrow ? 150 : 130, drawing = new Drawing(narrow ? 350 : 640, narrow ? 370 : 165);
      ["light", "after polariser", "after plate", "after analyser"].forEach((words, i) => {
        const [column, row] = narrow ? [i % 2, i >> 1] : [i, 0];
        ellipse(drawing, (narrow ? 12 : 14) + column * (narrow ? 176 : 161), 4 + row * 184, side, curve[`x${i}`], curve[`y${i}`], words);
      });
      const plot = new Plot(narrow, { height: 170, x: [0, 180], y: [0, 1], xTicks: [0, 45, 90, 135, 180], xLabel: "angle of the analyser [°]", yLabel: "S0 that passes" });
      plot.curve(curve.angle, curve.passed, "first");
      if (value.second) plot.dot(value.second_angle, curve.last[0]);
      return [drawing.svg, plot.drawing.svg];
    },
    lobe({ curve }, value, narrow) {
      const xAxis = { x: [-90, 90], xTicks: narrow ? [-90, -45, 0, 45, 90] : [-90, -60, -30, 0, 30, 60, 90], xLabel: "zenith angle of the viewer [°]" };
      const top = Math.max(...curve.f00, curve.here[0]);
      const f00 = new Plot(narrow, { ...xAxis, height: 200, y: [0, top * 1.05 || 1], yLabel: "f00 [sr⁻¹]" });
      f00.curve(curve.zenith, curve.f00, "first");
      f00.upright(-value.theta_i, "source"), f00.upright(value.theta_r);
      f00.dot(value.theta_r, curve.here[0]);
      const dolp = new Plot(narrow, { ...xAxis, height: 120, y: [0, 1], yLabel: "DoLP" });
      dolp.curve(curve.zenith, curve.DoLP, "second");
      dolp.upright(value.theta_r);
      return [f00.drawing.svg, dolp.drawing.svg];
    },
    plate() { return []; },
    sky({ curve }, value, _, figure) {
      const side = 300, middle = side / 2, radius = 140, drawing = new Drawing(side, side + 6);
      const to = (zenith, phi) => [middle - radius * zenith / 90 * Math.sin(phi * Math.PI / 180), middle + radius * zenith / 90 * Math.cos(phi * Math.PI / 180)];
      const scale = value.quantity === 0 ? Math.max(...curve.dome) : value.quantity === 1 ? 1 : 180;
      figure.disk = figure.disk || new Disk(4 * radius, 91, 180);
      const canvas = figure.disk.paint(curve.dome, scale, value.quantity === 2);
      const inside = drawing.add("foreignObject", { x: middle - radius, y: middle - radius, width: 2 * radius, height: 2 * radius });
      inside.append(canvas);
      drawing.add("circle", { cx: middle, cy: middle, r: radius, class: "frame" });
      const cross = ([x, y], r, kind) => { drawing.line([[x - r, y - r], [x + r, y + r]], kind); drawing.line([[x - r, y + r], [x + r, y - r]], kind); };
      for (const zenith of curve.points) for (const kind of ["halo", "point"]) cross(to(zenith, 0), 5, kind);
      for (const kind of ["halo", "point"]) drawing.dot(...to(value.sun, 0), `line ${kind}`, 8);
      const [x, y] = to(value.theta, value.phi);
      for (const kind of ["halo", "point"]) drawing.add("rect", { x: x - 5, y: y - 5, width: 10, height: 10, class: `line ${kind}` });
      return [drawing.svg, scaleOf(scale, value.quantity === 2, ["radiance", "DoLP", "AoLP [°]"][value.quantity])];
    },
    bias({ curve }, value, narrow) {
      const [widest, measured, debiased] = curve.scale, size = narrow ? 290 : 270;
      const cloud = new Drawing(350, size + 66), at = (x, y) => [60 + (x + widest) / (2 * widest) * size, 12 + (widest - y) / (2 * widest) * size];
      cloud.add("rect", { x: 60, y: 12, width: size, height: size, class: "frame" });
      for (const tick of ticks(-widest, widest)) {
        cloud.line([at(tick, -widest), at(tick, widest)], "grid"), cloud.line([at(-widest, tick), at(widest, tick)], "grid");
        cloud.text(at(tick, 0)[0], size + 30, minus(tick), { "text-anchor": "middle" });
        cloud.text(52, at(0, tick)[1] + 4.5, minus(tick), { "text-anchor": "end" });
      }
      const inside = Array.from(curve.S1, (s1, i) => [s1, curve.S2[i]]).filter(([s1, s2]) => Math.max(Math.abs(s1), Math.abs(s2)) < widest);
      cloud.add("path", { class: "draw", d: inside.map(([s1, s2]) => `M${at(s1, s2).map(place).join(" ")}h0`).join("") });
      const [x, y] = at(value.p0, 0);
      cloud.line([[x - 7, y], [x + 7, y]], "second"), cloud.line([[x, y - 7], [x, y + 7]], "second");
      cloud.text(60 + size / 2, size + 52, "S1 / S0 [%]", { "text-anchor": "middle" });
      cloud.text(14, 12 + size / 2, "S2 / S0 [%]", { "text-anchor": "middle", transform: `rotate(-90 14 ${12 + size / 2})` });
      const bars = new Plot(true, { height: size - (narrow ? 80 : 16), x: [0, widest], y: [0, Math.max(...curve.count) * 1.1], xLabel: "measured DoLP [%]",
        yLabel: "share of the measurements", legend: [["mark", "true"], ["second", "mean"], ["first", "debiased"]] });
      const width = widest / curve.count.length;
      const steps = Array.from(curve.count, (count, i) => [bars.to(i * width, count), bars.to((i + 1) * width, count)]).flat();
      bars.drawing.add("path", { class: "bar", d: path([bars.to(0, 0), ...steps, bars.to(widest, 0)]) + "Z" });
      bars.upright(value.p0), bars.upright(measured, "second"), bars.upright(debiased, "first");
      return [cloud.svg, bars.drawing.svg];
    },
    sampling({ curve }, value) {
      const side = 320, middle = side / 2, radius = 148, drawing = new Drawing(side, side);
      const to = (zenith, phi) => [middle + radius * zenith / 90 * Math.cos(phi * Math.PI / 180), middle - radius * zenith / 90 * Math.sin(phi * Math.PI / 180)];
      for (const zenith of [30, 60, 90]) drawing.add("circle", { cx: middle, cy: middle, r: radius * zenith / 90, class: zenith === 90 ? "frame" : "ring" });
      for (const zenith of [30, 60]) drawing.text(middle + 3, middle - radius * zenith / 90 - 3, `${zenith}°`, { class: "small" });
      const most = Math.max(...curve.share, 1e-12);
      const dot = ([x, y], r) => `M${place(x - r)} ${place(y)}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`;
      curve.zenith.forEach((zenith, i) => drawing.add("path", { class: "sample",
        d: dot(to(zenith, curve.azimuth[i]), place(1 + 4.5 * Math.sqrt(Math.max(curve.share[i], 0) / most))) }));
      const [x, y] = to(value.viewer, 0);
      drawing.add("rect", { x: x - 5, y: y - 5, width: 10, height: 10, class: "line second" });
      return drawing.svg;
    },
    fresnel({ curve }, value, narrow) {
      const plot = new Plot(narrow, { x: [0, 90], y: [0, 1], xTicks: [0, 15, 30, 45, 60, 75, 90], xLabel: "angle of incidence [°]",
        yLabel: "reflectance, DoP", legend: [["first", "Rs"], ["second", "Rp"], ["third", "DoP"]] });
      for (const [name, kind] of [["Rs", "first"], ["Rp", "second"], ["DoP", "third"]]) plot.curve(curve.angle, curve[name], kind);
      plot.upright(value.theta);
      return plot.drawing.svg;
    },
  };

  // ---------------------------------------------------------------- a figure on the page
  const shown = (control, value) => minus(Number(value).toFixed(Math.max(0, -Math.floor(Math.log10(control.step) + 1e-9))));

  class Figure {
    constructor(program, figure, element) {
      Object.assign(this, { program, figure, element });
      this.picture = make("div", { class: "live-picture", role: "img" });
      this.numbers = make("dl", { class: "live-numbers", "data-columns": figure.columns });
      this.message = make("p", { class: "live-message", role: "status" });
      const reset = make("button", { type: "button" }, "Reset");
      reset.addEventListener("click", () => this.reset());
      this.controls = figure.controls.map((control) => this.control(control));
      const form = make("form", { class: "live-controls", "aria-label": `Controls: ${figure.title}` }, ...this.controls.map((one) => one.row), reset);
      form.addEventListener("submit", (event) => event.preventDefault());
      const caption = make("figcaption", { class: "ltx_caption" }, make("b", {}, `Live figure: ${figure.title}. `), figure.caption);
      element.replaceChildren(this.picture, form, this.numbers, this.message, caption);
      element.setAttribute("aria-label", `Live figure: ${figure.title}`);
      element.hidden = false;
      this.narrow = element.clientWidth < 520;  // asked at a change alone, since it lays out the whole page
      this.reset();
      new ResizeObserver(([{ contentRect }]) => {
        if (this.narrow === contentRect.width < 490) return;
        this.narrow = !this.narrow;
        this.update();
      }).observe(element);
    }
    // a slider or a choice, with its label and its value
    control(control) {
      const id = `live-${this.figure.name}-${control.name}`;
      const choice = control.choices.length > 0;
      const input = choice
        ? make("select", { id }, ...control.choices.map((words, i) => make("option", { value: i }, words)))
        : make("input", { id, type: "range", min: control.least, max: control.most, step: control.step });
      const output = make("output", { for: id });
      input.addEventListener("input", () => this.update());
      const row = make("div", { class: "live-control" }, make("label", { for: id }, control.label), input, choice ? "" : output);
      return { control, input, output, row };
    }
    reset() {
      for (const { control, input } of this.controls) input.value = control.initial;
      this.update();
    }
    values() { return this.controls.map(({ input }) => Number(input.value)); }
    update() {
      const began = performance.now();
      const values = this.values();
      const answer = this.program.evaluate(this.figure, values);
      this.message.textContent = answer.error || "";
      if (answer.error) return;
      this.controls.forEach(({ control, output, input }, i) => {
        const words = shown(control, values[i]) + (control.unit === "°" ? "°" : control.unit && ` ${control.unit}`);
        output.textContent = words;
        if (!control.choices.length) input.setAttribute("aria-valuetext", words);
      });
      this.say(answer.numbers);
      const value = Object.fromEntries(this.controls.map(({ control }, i) => [control.name, values[i]]));
      this.picture.replaceChildren(...[draw[this.figure.name](answer, value, this.narrow, this)].flat());
      this.picture.setAttribute("aria-label", `${this.figure.shows} Now ` +
        this.controls.map(({ control, input, output }) => `${control.label} ${control.choices[input.value] || output.textContent}`).join(", ") + ".");
      this.element.dataset.milliseconds = (performance.now() - began).toFixed(2);
    }
    say(numbers) {
      this.numbers.replaceChildren(...numbers.map(({ label, text, unit, printed }) => {
        const value = make("dd", {}, make("span", { class: "live-number" }, minus(text)), unit === "°" ? unit : unit && ` ${unit}`);
        if (printed) value.append(make("span", { class: "live-printed" + (printed === text ? "" : " differs") }, minus(printed)));
        return make("div", {}, make("dt", {}, label), value);
      }));
    }
    // what fills a table of the program, while nothing else is to be done: all values of some controls with each other
    prepare() {
      let all = [this.figure.controls.map((control) => control.initial)];
      this.figure.controls.forEach((control, i) => {
        if (!control.prepared) return;
        const input = make("input", { type: "range", min: control.least, max: control.most, step: control.step });
        const count = Math.round((control.most - control.least) / control.step);
        all = Array.from({ length: count + 1 }, (_, step) => {
          input.value = control.least + step * control.step;  // rounded as a slider does
          return all.map((values) => values.with(i, Number(input.value)));
        }).flat();
      });
      return all.length > 1 ? all.map((values) => () => this.program.evaluate(this.figure, values)) : [];
    }
  }

  const elements = [...document.querySelectorAll("[data-live]")];
  if (elements.length && typeof malusLive === "function" && typeof WebAssembly === "object")
    malusLive().then((module) => {
      const program = new Program(module);
      const figures = elements.map((element) =>
        new Figure(program, program.figures.find((figure) => figure.name === element.dataset.live), element));
      const work = figures.flatMap((figure) => figure.prepare());
      const idle = window.requestIdleCallback || ((then) => setTimeout(then, 50));
      const next = () => { if (work.length) { work.shift()(); idle(next); } };
      idle(next);
      document.documentElement.dataset.liveReady = performance.now().toFixed(0);
    });
})();
