"use strict";
const el = (id) => document.getElementById(id);
const canvas = el("scene"), pen = canvas.getContext("2d");
const frames = data.frames, end = frames[frames.length - 1][0];
const last = data.releases.length ? data.releases[data.releases.length - 1][1] : end;
const body = ["#0072b2", "#d55e00"], axes = ["#332288", "#2a9d8f", "#cc6677"];
const NEAREST = "#c1121f", SPRING = "#009e73", MOMENTUM = "#8a2d6b", INK = "#222222", MUTED = "#5b6675", IDLE = "#8c8c8c";
const FAILED = "#86210d", LATE = "#6f4a00", WORDS = ["#332288", "#1d7a70", "#b04456"];
// What stands below the scene, and nothing of the scene with it.
const STRIP = 70;

// Vectors and quaternions, scalar last.
const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
const times = (a, k) => [a[0] * k, a[1] * k, a[2] * k];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const norm = (a) => Math.hypot(...a);
const turn = (q, v) => {
  const u = [q[0], q[1], q[2]], t = times(cross(u, v), 2);
  return add(add(v, times(t, q[3])), cross(u, t));
};

// What may be missing.
const between = (k, a, b, share) => (a[k] === null || b[k] === null ? null : a[k] + (b[k] - a[k]) * share);
// The frame at a time: between two, straight but for attitudes, which turn.
function at(time) {
  let i = 0, j = frames.length - 1;
  while (j - i > 1) { const k = (i + j) >> 1; if (frames[k][0] <= time) i = k; else j = k; }
  const a = frames[i], b = frames[j], span = b[0] - a[0];
  const share = span > 0 ? Math.min(1, Math.max(0, (time - a[0]) / span)) : 0;
  const mix = (from, to) => {
    const out = [];
    for (let k = from; k < to; k++) out.push(a[k] + (b[k] - a[k]) * share);
    return out;
  };
  // At an even rate, about one axis.
  const attitude = (k) => {
    const p = a.slice(k, k + 4), q = b.slice(k, k + 4);
    const cosine = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3], sign = cosine < 0 ? -1 : 1;
    const angle = Math.acos(Math.min(1, Math.abs(cosine))), sine = Math.sin(angle);
    const [of, to] = sine > 1e-4 ? [Math.sin((1 - share) * angle) / sine, Math.sin(share * angle) / sine] : [1 - share, share];
    const m = p.map((x, n) => x * of + sign * q[n] * to), size = Math.hypot(...m);
    return m.map((x) => x / size);
  };
  return {
    x: [mix(1, 4), mix(11, 14)], q: [attitude(4), attitude(14)], w: [mix(8, 11), mix(18, 21)],
    h: mix(21, 24), nutation: between(24, a, b, share), apart: between(25, a, b, share),
  };
}

// With outlines the boxes are drawn if they are asked for.
const boxes = el("boxes"), withBoxes = () => !boxes || boxes.checked;
const radius = data.boxes.map((box) => (data.outlines ? 0 : norm(box.sides) / 2));
// What has to be seen: bodies and the points of the springs.
data.springs.forEach((spring) => {
  radius[0] = Math.max(radius[0], norm(spring.p)); radius[1] = Math.max(radius[1], norm(spring.s));
});
const shapes = data.outlines || [[], []];
const parts = (shape) => shape.hull || shape.points || shape.ring.slice(1).map((r) => [0, 1, 2].map((k) => Math.abs(shape.ring[0][k]) + Math.abs(r[k])));
shapes.forEach((list, i) => list.forEach((shape) => parts(shape).forEach((p) => { radius[i] = Math.max(radius[i] || 0, norm(p)); })));
// The corners of points on the page, in turn.
function shadow(points) {
  const sorted = points.slice().sort((a, b) => a[0] - b[0] || a[1] - b[1]);
  const half = (list) => {
    const out = [];
    list.forEach((p) => {
      while (out.length > 1) {
        const [a, b] = out.slice(-2);
        if ((b[0] - a[0]) * (p[1] - a[1]) - (b[1] - a[1]) * (p[0] - a[0]) > 0) break;
        out.pop();
      }
      out.push(p);
    });
    return out.slice(0, -1);
  };
  return half(sorted).concat(half(sorted.reverse()));
}
const largest = (values) => values.reduce((a, b) => Math.max(a, b), -Infinity), least = (values) => values.reduce((a, b) => Math.min(a, b), Infinity);
const most = largest(frames.map((f) => norm(f.slice(21, 24)))) || 1;
const VIEW = [0.9, 0.32, 1];
let [yaw, pitch, zoom] = VIEW, time = 0, playing = true, before = null;
// The first half of the slider and of the charts are the springs, where they are over soon.
const knee = data.releases.length && last < end / 4 ? 1.2 * last : end;
const share = (t) => (end > 0 ? (knee === end ? t / end : t <= knee ? 0.5 * t / knee : 0.5 + 0.5 * (t - knee) / (end - knee)) : 0);
const timeAt = (x) => (knee === end ? x * end : x <= 0.5 ? 2 * x * knee : knee + (2 * x - 1) * (end - knee));
const shown = (t) => t.toFixed(end < 1 ? 5 : 3);
// Numbers that are stated once, with as many digits as the terminal has.
const rounded = (x) => `${+x.toPrecision(6)}`.replace(/-/g, "−");

// One that fails has no start.
const isPushing = (spring) => spring.from !== null && time >= spring.from && (spring.free === null || time < spring.free);

// From the stage's point of a spring to its free end, in stage axes: where it is held until it starts, and as long as it is
// when it lets go.
const still = (spring, t) => {
  const now = at(t), [x, y, z, w] = now.q[1], a = add(now.x[1], turn(now.q[1], spring.s)), b = add(now.x[0], turn(now.q[0], spring.p));
  return turn([-x, -y, -z, w], add(b, times(a, -1)));
};
data.springs.forEach((spring) => {
  spring.held = still(spring, 0);
  spring.loose = spring.free === null ? spring.held : still(spring, spring.free);
});

// Inertial 3 up; returns across, up and towards the eye.
function view(v) {
  const c = Math.cos(yaw), s = Math.sin(yaw), d = Math.cos(pitch), e = Math.sin(pitch);
  const near = c * v[0] + s * v[1];
  return [-s * v[0] + c * v[1], d * v[2] - e * near, d * near + e * v[2]];
}

const CORNERS = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1 ? 0.5 : -0.5, i & 2 ? 0.5 : -0.5, i & 4 ? 0.5 : -0.5]);
const FACES = [[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]];

function draw() {
  const ratio = window.devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
    canvas.width = Math.round(width * ratio); canvas.height = Math.round(height * ratio);
  }
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, width, height);
  pen.lineJoin = pen.lineCap = "round";
  const now = at(time);
  let lift = 0, sink = 0, wide = 0;
  now.x.forEach((x, i) => {
    const v = view(x);
    lift = Math.max(lift, v[1] + radius[i]); sink = Math.min(sink, v[1] - radius[i]);
    wide = Math.max(wide, Math.abs(v[0]) + radius[i]);
  });
  const high = height - STRIP;
  const scale = zoom * Math.min(0.94 * high / (lift - sink), 0.47 * width / wide) || 1;
  const middle = (lift + sink) / 2;
  const point = (v) => { const p = view(v); return [width / 2 + p[0] * scale, high / 2 - (p[1] - middle) * scale, p[2]]; };
  const things = [];
  const line = (a, b, colour, thick, alpha) => {
    const p = point(a), q = point(b);
    things.push({ depth: (p[2] + q[2]) / 2, draw() {
      pen.globalAlpha = alpha || 1; pen.strokeStyle = colour; pen.lineWidth = thick;
      pen.beginPath(); pen.moveTo(p[0], p[1]); pen.lineTo(q[0], q[1]); pen.stroke(); pen.globalAlpha = 1;
    } });
  };
  const arrow = (from, along, colour, thick) => {
    const to = add(from, along), p = point(from), q = point(to);
    line(from, to, colour, thick);
    const x = q[0] - p[0], y = q[1] - p[1], size = Math.hypot(x, y);
    if (size < 4) return;
    const tip = Math.min(5 + 2 * thick, size), u = x / size, v = y / size;
    things.push({ depth: q[2], draw() {
      pen.fillStyle = colour; pen.beginPath(); pen.moveTo(q[0] + u * 2, q[1] + v * 2);
      pen.lineTo(q[0] - tip * u - tip * 0.45 * v, q[1] - tip * v + tip * 0.45 * u);
      pen.lineTo(q[0] - tip * u + tip * 0.45 * v, q[1] - tip * v - tip * 0.45 * u); pen.fill();
    } });
  };
  if (withBoxes()) data.boxes.forEach((box, i) => {
    const corners = CORNERS.map((c) =>
      add(now.x[i], turn(now.q[i], turn(box.q, [c[0] * box.sides[0], c[1] * box.sides[1], c[2] * box.sides[2]]))));
    const flat = corners.map(point);
    FACES.forEach((face) => {
      const [a, b, c, d] = face.map((k) => flat[k]);
      const faces = (b[0] - a[0]) * (d[1] - a[1]) - (b[1] - a[1]) * (d[0] - a[0]);
      things.push({ depth: (a[2] + b[2] + c[2] + d[2]) / 4, draw() {
        pen.beginPath(); pen.moveTo(a[0], a[1]); pen.lineTo(b[0], b[1]); pen.lineTo(c[0], c[1]);
        pen.lineTo(d[0], d[1]); pen.closePath();
        pen.fillStyle = body[i]; pen.globalAlpha = (faces < 0 ? 0.13 : 0.2) * (data.outlines ? 0.4 : 1); pen.fill();
        pen.strokeStyle = body[i]; pen.lineWidth = data.outlines ? 0.8 : 1.2; pen.globalAlpha = data.outlines ? 0.3 : 0.75; pen.stroke(); pen.globalAlpha = 1;
      } });
    });
  });
  data.boxes.forEach((_, i) => axes.forEach((colour, k) => {
    const unit = [0, 0, 0]; unit[k] = 0.75 * radius[i];
    arrow(now.x[i], turn(now.q[i], unit), colour, 1.6);
  }));
  shapes.forEach((list, i) => list.forEach((shape) => {
    const place = (v) => add(now.x[i], turn(now.q[i], v));
    const path = (points) => { pen.beginPath(); points.forEach((p) => pen.lineTo(p[0], p[1])); };
    if (shape.ring) {
      const [c, u, w] = shape.ring, steps = 72;
      const at = (k) => place(add(c, add(times(u, Math.cos(2 * Math.PI * k / steps)), times(w, Math.sin(2 * Math.PI * k / steps)))));
      for (let k = 0; k < steps; k++) line(at(k), at(k + 1), body[i], 2.4, 0.9);
      return;
    }
    const points = (shape.hull || shape.points).map((v) => point(place(v)));
    if (shape.points) {
      points.forEach((p) => things.push({ depth: p[2], draw() { pen.fillStyle = body[i]; pen.beginPath(); pen.arc(p[0], p[1], 3, 0, 7); pen.fill(); } }));
      return;
    }
    // The shadow lies behind all its edges.
    things.push({ depth: Math.min(...points.map((p) => p[2])), draw() {
      path(shadow(points)); pen.closePath(); pen.fillStyle = pen.strokeStyle = body[i];
      pen.globalAlpha = 0.16; pen.fill(); pen.globalAlpha = 0.9; pen.lineWidth = 1.4; pen.stroke(); pen.globalAlpha = 1;
    } });
    shape.edges.forEach(([a, b]) => {
      const p = points[a], q = points[b];
      things.push({ depth: (p[2] + q[2]) / 2, draw() {
        pen.globalAlpha = 0.45; pen.strokeStyle = body[i]; pen.lineWidth = 1;
        path([p, q]); pen.stroke(); pen.globalAlpha = 1;
      } });
    });
  }));
  if (data.closest) {
    const a = add(now.x[0], turn(now.q[0], data.closest.p)), b = add(now.x[1], turn(now.q[1], data.closest.s));
    line(a, b, NEAREST, 1.6);
    [a, b].map(point).forEach((p) => things.push({ depth: p[2] + 1e-3, draw() { pen.fillStyle = NEAREST; pen.beginPath(); pen.arc(p[0], p[1], 3, 0, 7); pen.fill(); } }));
  }
  if (data.boxes.length) {
    const spin = turn(now.q[0], data.spin), long = 1.3 * radius[0];
    line(add(now.x[0], times(spin, -long)), add(now.x[0], times(spin, long)), INK, 1.1, 0.7);
    const size = norm(now.h);
    if (size > 1e-9 * most) arrow(now.x[0], times(now.h, (1.35 * radius[0]) * Math.max(0.15, size / most) / size), MOMENTUM, 3);
  }
  // Springs stand on the stage, and push the payload by their other end.
  const labels = [];
  const centre = point(now.x[1]);
  data.springs.forEach((spring) => {
    const pushes = isPushing(spring), a = add(now.x[1], turn(now.q[1], spring.s)), pad = add(now.x[0], turn(now.q[0], spring.p));
    const waits = spring.from !== null && time < spring.from;
    const b = pushes ? pad : add(a, turn(now.q[1], spring.from === null || waits ? spring.held : spring.loose));
    const p = point(a), q = point(b), o = point(pad);
    things.push({ depth: (p[2] + q[2]) / 2, draw() {
      const x = q[0] - p[0], y = q[1] - p[1], size = Math.hypot(x, y) || 1, wave = Math.min(7, 0.3 * size + 2), u = -y / size, v = x / size;
      pen.strokeStyle = pushes ? SPRING : IDLE; pen.lineWidth = pushes ? 2.4 : 1.5; pen.beginPath(); pen.moveTo(p[0], p[1]);
      for (let k = 1; k < 10; k++) {
        const side = (k % 2 ? 1 : -1) * wave, part = k / 10;
        pen.lineTo(p[0] + x * part + u * side, p[1] + y * part + v * side);
      }
      pen.lineTo(q[0], q[1]);
      if (!pushes) { pen.moveTo(q[0] - u * wave, q[1] - v * wave); pen.lineTo(q[0] + u * wave, q[1] + v * wave); }
      pen.stroke();
      [[o, body[0]], [p, body[1]]].forEach(([at, colour]) => { pen.fillStyle = colour; pen.fillRect(at[0] - 3.5, at[1] - 2, 7, 4); });
    } });
    const late = spring.late ? " late" : "";
    labels.push([p, centre, spring.name + (spring.from === null ? " ✕" : late), spring.from === null ? FAILED : waits ? LATE : INK]);
  });
  things.sort((a, b) => a.depth - b.depth).forEach((thing) => thing.draw());
  // Names, which lie on no other.
  const taken = [];
  pen.font = "600 12px system-ui, sans-serif"; pen.textAlign = "center"; pen.textBaseline = "middle";
  labels.forEach(([p, from, text, colour]) => {
    const x = p[0] - from[0], y = p[1] - from[1], size = Math.hypot(x, y) || 1, wide = pen.measureText(text).width + 6;
    for (let away = 18; away < 120; away += 9) {
      const box = [p[0] + x / size * (away + wide / 3) - wide / 2, p[1] + y / size * away - 8, wide, 16];
      if (taken.some((t) => box[0] < t[0] + t[2] && t[0] < box[0] + box[2] && box[1] < t[1] + t[3] && t[1] < box[1] + box[3])) continue;
      taken.push(box);
      pen.fillStyle = "#ffffffcc"; pen.fillRect(...box);
      pen.fillStyle = colour; pen.fillText(text, box[0] + wide / 2, box[1] + 8);
      break;
    }
  });
  pen.textBaseline = "alphabetic";
  // Inertial axes and a rule, in a strip of their own.
  pen.fillStyle = "#ffffff"; pen.fillRect(0, high, width, STRIP);
  const corner = [44, height - 34];
  axes.forEach((colour, k) => {
    const unit = [0, 0, 0]; unit[k] = 20;
    const v = view(unit);
    pen.strokeStyle = "#8c8c8c"; pen.lineWidth = 1.2; pen.beginPath(); pen.moveTo(...corner);
    pen.lineTo(corner[0] + v[0], corner[1] - v[1]); pen.stroke();
    pen.fillStyle = MUTED; pen.font = "11px system-ui, sans-serif"; pen.textAlign = "center";
    pen.fillText(k + 1, corner[0] + 1.45 * v[0], corner[1] - 1.45 * v[1] + 4);
  });
  pen.textAlign = "left";
  pen.fillText("inertial axes", 88, height - 12);
  const decade = 10 ** Math.floor(Math.log10(120 / scale)), metres = [5, 2, 1].find((m) => m * decade * scale < 130) * decade;
  pen.strokeStyle = MUTED; pen.beginPath();
  const right = width - 16, low = height - 16;
  pen.moveTo(right - metres * scale, low - 4); pen.lineTo(right - metres * scale, low); pen.lineTo(right, low); pen.lineTo(right, low - 4); pen.stroke();
  pen.textAlign = "right"; pen.fillText(`${+metres.toPrecision(2)} m`, right, low - 8);

  const pushing = data.springs.filter(isPushing).length;
  el("clock").textContent = `${shown(time)} of ${shown(end)} s`;
  el("time").value = 1000 * share(time);
  el("time").setAttribute("aria-valuetext", `${shown(time)} seconds`);
  const rate = (w) => w.map((x) => x.toFixed(4).replace("-", "−")).join(", ");
  const away = norm(add(now.x[0], times(now.x[1], -1)));
  const named = (of) => data.springs.filter(of).map((spring) => spring.name).join(", ");
  const failed = named((spring) => spring.from === null), late = data.springs.filter((spring) => spring.late);
  const rows = [
    ["springs that push", `${pushing} of ${data.springs.length}`],
    ...(failed ? [["springs that never push", failed]] : []),
    ...(late.length ? [["springs that start late", late.map((spring) => `${spring.name} at ${rounded(spring.from)} s`).join(", ")]] : []),
    ["distance of the mass centres", `${away.toFixed(4)} m`],
    ...(now.apart === null ? [] : [["distance of the outlines", `${now.apart.toFixed(4)} m`]]),
    ["payload rates 1, 2, 3", `${rate(now.w[0])} deg/s`],
    ["stage rates 1, 2, 3", `${rate(now.w[1])} deg/s`],
    ...(data.closest ? [["clearance after the last release", data.closest.d > 0 ? `${rounded(data.closest.d)} m at ${rounded(data.closest.t)} s` : `touch at ${rounded(data.closest.t)} s`]] : []),
    ["nutation", now.nutation === null ? "–" : `${now.nutation.toFixed(4)}°`],
  ];
  const table = el("now");
  while (table.rows.length < rows.length) {
    const row = table.insertRow(), head = document.createElement("th");
    head.scope = "row"; row.append(head); row.insertCell();
  }
  rows.forEach((row, i) => row.forEach((text, k) => { table.rows[i].cells[k].textContent = text; }));
  cursors.forEach((cursor) => cursor.setAttribute("transform", `translate(${share(time) * PLOT[0]} 0)`));
}

// Charts beside the scene, over the same time as the slider.
const SVG = Object.assign(document.createElement("template"), { innerHTML: "<svg></svg>" }).content.firstChild.namespaceURI;
const PLOT = [300, 64], TOP = 22, cursors = [];
// What has room to its left for the widest label of an axis; the same for all charts, for they share the time.
const rule = document.createElement("canvas").getContext("2d");
rule.font = "11px system-ui, sans-serif";
const words = (y) => (y === 0 ? "0" : Math.abs(y) >= 1e-3 && Math.abs(y) < 1e5 ? `${+y.toPrecision(4)}` : y.toExponential(2)).replace(/-/g, "−");
const bounds = (values) => {
  const low = least(values), high = largest(values);
  if (high - low > 1e-9 * Math.max(Math.abs(low), Math.abs(high))) return [low, high];
  const pad = Math.abs(high) || 1;
  return [low - 0.05 * pad, high + 0.05 * pad];
};
const charts = [];
const chart = (label, colour, lines) => {
  const values = lines.flatMap(([, of]) => frames.map(of)).filter((y) => y !== null);
  if (values.length) charts.push({ label, colour, lines, seen: [least(values), largest(values)], bounds: bounds(values) });
};
function show({ label, colour, lines, seen, bounds: [low, high] }, LEFT) {
  const make = (name, within, attributes, text) => {
    const made = document.createElementNS(SVG, name);
    Object.entries(attributes).forEach(([key, value]) => made.setAttribute(key, value));
    if (text !== undefined) made.textContent = text;
    within.append(made);
    return made;
  };
  const [wide, tall] = [LEFT + PLOT[0] + 10, TOP + PLOT[1] + 22];
  const svg = make("svg", el("charts"), { viewBox: `0 0 ${wide} ${tall}`, role: "img", "font-size": 11, "font-family": "system-ui, sans-serif", fill: "none" });
  make("title", svg, {}, label);
  make("desc", svg, {}, `From ${words(seen[0])} to ${words(seen[1])} over ${shown(end)} seconds.`);
  const y = (value) => PLOT[1] * (1 - (value - low) / (high - low));
  make("text", svg, { x: LEFT, y: 13, fill: colour, "font-weight": 600 }, label);
  lines.length > 1 && lines.forEach(([, , , ink], k) => make("text", svg, { x: wide - 10 - 16 * (lines.length - 1 - k), y: 13, fill: ink, "font-weight": 600, "text-anchor": "end" }, k + 1));
  const plot = make("g", svg, { transform: `translate(${LEFT} ${TOP})` });
  make("rect", plot, { width: PLOT[0], height: PLOT[1], fill: "#ffffff", stroke: "#d8dee6" });
  if (low < 0 && high > 0) make("path", plot, { d: `M0 ${y(0)}h${PLOT[0]}`, stroke: "#d8dee6" });
  [[low, PLOT[1]], [high, 8]].forEach(([value, at]) => make("text", svg, { x: LEFT - 5, y: TOP + at, fill: MUTED, "text-anchor": "end" }, words(value)));
  const ticks = knee === end ? [0, end] : [0, knee, end];
  ticks.forEach((t, k) => make("text", svg, { x: LEFT + share(t) * PLOT[0], y: tall - 7, fill: MUTED, "text-anchor": ["start", "middle", "end"][k === ticks.length - 1 ? 2 : k] }, `${+t.toPrecision(3)} s`));
  data.releases.forEach(([, t]) => make("path", plot, { d: `M${share(t) * PLOT[0]} 0v${PLOT[1]}`, stroke: IDLE, "stroke-width": 0.7, "stroke-dasharray": "3 3" }));
  lines.forEach(([, of, ink]) => {
    // In each half pixel the first, the last, the lowest and the highest: what swings faster is as wide as it swings.
    let d = "", on = false, column = [];
    const flush = () => {
      const heights = column.map((p) => p[1]), ends = [heights.indexOf(least(heights)), heights.indexOf(largest(heights))];
      const kept = new Set([0, ...ends.sort((p, q) => p - q), column.length - 1]);
      if (column.length) kept.forEach((k) => { d += `${on ? "L" : "M"}${column[k][0].toFixed(1)} ${column[k][1].toFixed(1)}`; on = true; });
      column = [];
    };
    frames.forEach((frame) => {
      const value = of(frame), x = share(frame[0]) * PLOT[0];
      if (column.length && (value === null || x - column[0][0] > 0.5)) flush();
      if (value === null) on = false; else column.push([x, y(value)]);
    });
    flush();
    make("path", plot, { d, stroke: ink, "stroke-width": 1.5 });
  });
  cursors.push(make("path", plot, { d: `M0 0v${PLOT[1]}`, stroke: INK, "stroke-width": 1.2 }));
}
const rates = (label, colour, from) => chart(label, colour, axes.map((ink, k) => [k + 1, (f) => f[from + k], ink, WORDS[k]]));
chart("distance of the mass centres (m)", INK, [["", (f) => Math.hypot(f[1] - f[11], f[2] - f[12], f[3] - f[13]), INK]]);
chart("distance of the outlines (m)", INK, [["", (f) => f[25], INK]]);
rates("payload rates (deg/s)", "#0072b2", 8);
rates("stage rates (deg/s)", "#b34f00", 18);
chart("nutation of the payload (deg)", "#0072b2", [["", (f) => f[24], body[0]]]);
const room = Math.ceil(largest(charts.flatMap((of) => of.bounds.map((y) => rule.measureText(words(y)).width)))) + 12;
charts.forEach((of) => show(of, Math.max(58, room)));

// What happens, marked on the slider: buttons that go there; what is near another shares its mark.
const events = [
  ...data.springs.filter((spring) => spring.late && spring.from <= end).map((spring) => [spring.from, `${spring.name} starts`, `${spring.label} starts`]),
  ...data.releases.map(([name, t, label]) => [t, name, `${label} lets go`]),
].sort((a, b) => a[0] - b[0]);
// Marks that would lie on each other are one: how wide they are is known once they stand there.
function mark() {
  const place = el("marks"), width = place.clientWidth;
  const button = ({ t, to, names, texts }) => {
    const made = document.createElement("button");
    made.type = "button"; made.style.left = `${50 * (share(t) + share(to))}%`;
    made.textContent = names.length > 3 ? `${names[0]} … ${names[names.length - 1]}` : names.join(" ");
    made.title = `${texts.join(", ")}: ${t === to ? t : `${t} to ${to}`} s`;
    made.ariaLabel = `${made.textContent}: ${made.title}`;
    made.onclick = () => go(t);
    place.append(made);
    return made;
  };
  const half = (made) => made.offsetWidth / 2, centre = ({ t, to }) => (share(t) + share(to)) / 2 * width;
  const marks = [];
  place.replaceChildren();
  events.forEach(([t, name, text]) => {
    let last = { t, to: t, names: [name], texts: [text] };
    last.made = button(last);
    while (marks.length) {
      const before = marks[marks.length - 1];
      if (centre(last) - half(last.made) >= centre(before) + half(before.made) + 2) break;
      marks.pop(); before.made.remove(); last.made.remove();
      last = { t: before.t, to: last.to, names: inOrder(before.names.concat(last.names)), texts: before.texts.concat(last.texts) };
      last.made = button(last);
    }
    marks.push(last);
  });
}
const inOrder = (names) => names.sort((a, b) => a.localeCompare(b, "en", { numeric: true }));
mark();
function go(t) { time = Math.max(0, Math.min(end, t)); play(false); draw(); }
const step = (by) => go(timeAt(Math.max(0, Math.min(1, share(time) + by / 200))));
// A hair beyond, for times are rounded.
const jump = (by) => {
  const times = [0, ...events.map(([t]) => t), end], hair = 1e-6 * end;
  const found = by > 0 ? times.find((t) => t > time + hair) : times.findLast((t) => t < time - hair);
  if (found !== undefined) go(found);
};
function reset() { [yaw, pitch, zoom] = VIEW; go(0); }

// Springs in eight seconds at first, the coast a tenth as slow as needed.
const speeds = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
// And no body faster than the eye follows, twenty degrees in a sixtieth of a second.
const fastest = largest(frames.map((f) => Math.max(norm(f.slice(8, 11)), norm(f.slice(18, 21)))));
const wanted = Math.min(end / 10, Math.max(last / 2, end / 60), fastest > 0 ? 1200 / fastest : end);
let speed = speeds.reduce((a, b) => (Math.abs(Math.log(b / wanted)) < Math.abs(Math.log(a / wanted)) ? b : a));
speeds.forEach((s) => el("speed").append(new Option(`× ${s}`, s, false, s === speed)));
el("speed").onchange = () => { speed = +el("speed").value; };
function play(on) { playing = on; el("play").textContent = on ? "Pause" : "Play"; before = null; }
el("play").onclick = () => { if (!playing && time >= end) time = 0; play(!playing); };
el("time").oninput = () => go(timeAt(el("time").value / 1000));
el("back").onclick = () => step(-1); el("on").onclick = () => step(1);
el("last").onclick = () => jump(-1); el("next").onclick = () => jump(1);
el("reset").onclick = reset;
if (boxes) boxes.onchange = draw;
const tilt = (by) => { pitch = Math.max(-1.57, Math.min(1.57, pitch + by)); };
const scaled = (by) => { zoom = Math.max(0.1, Math.min(20, zoom * by)); };
document.onkeydown = (event) => {
  const on = event.target.tagName;
  if (event.ctrlKey || event.altKey || event.metaKey || on === "SELECT") return;
  const keys = {
    ",": () => step(-1), ".": () => step(1), "[": () => jump(-1), "]": () => jump(1), r: reset, "+": () => scaled(1.2), "-": () => scaled(1 / 1.2),
    ...(on === "BUTTON" || event.target === boxes ? {} : { " ": () => el("play").click() }),
    ...(event.target === canvas ? { ArrowLeft: () => { yaw += 0.1; }, ArrowRight: () => { yaw -= 0.1; }, ArrowUp: () => tilt(0.1), ArrowDown: () => tilt(-0.1) } : {}),
  };
  if (!Object.hasOwn(keys, event.key)) return;
  event.preventDefault(); keys[event.key](); draw();
};
// One finger or the mouse turns; two fingers zoom.
const held = new Map();
canvas.onpointerdown = (event) => { canvas.setPointerCapture(event.pointerId); held.set(event.pointerId, [event.clientX, event.clientY]); };
canvas.onpointermove = (event) => {
  const was = held.get(event.pointerId), is = [event.clientX, event.clientY];
  if (!was) return;
  const other = [...held].find(([id]) => id !== event.pointerId);
  if (other) {
    const apart = (p) => Math.hypot(p[0] - other[1][0], p[1] - other[1][1]) || 1;
    scaled(apart(is) / apart(was));
  } else {
    yaw -= (is[0] - was[0]) * 0.008; tilt((is[1] - was[1]) * 0.008);
  }
  held.set(event.pointerId, is); draw();
};
canvas.onpointerup = canvas.onpointercancel = (event) => held.delete(event.pointerId);
canvas.addEventListener("wheel", (event) => { event.preventDefault(); scaled(Math.exp(-event.deltaY * 0.0015)); draw(); }, { passive: false });
window.onresize = () => { mark(); draw(); };
// A page opened at #t=0.2 stands still there.
const start = /^#t=([0-9.]+)$/.exec(location.hash);
if (start) { time = Math.min(end, +start[1] || 0); play(false); }
if (window.matchMedia("(prefers-reduced-motion: reduce)").matches) play(false);
function tick(stamp) {
  if (playing) {
    if (before !== null) time += (stamp - before) / 1000 * speed;
    before = stamp;
    if (time >= end) { time = end; play(false); }
    draw();
  }
  requestAnimationFrame(tick);
}
draw();
requestAnimationFrame(tick);
