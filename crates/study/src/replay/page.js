"use strict";
const el = (id) => document.getElementById(id);
const canvas = el("scene"), pen = canvas.getContext("2d");
const frames = data.frames, end = frames[frames.length - 1][0];
const last = data.releases.length ? data.releases[data.releases.length - 1][1] : end;
const body = ["#0072b2", "#d55e00"], axes = ["#332288", "#2a9d8f", "#cc6677"];
const NEAREST = "#c1121f", SPRING = "#009e73", MOMENTUM = "#8a2d6b", INK = "#222222";

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

// The frame at a time: between two, straight but for attitudes brought back to unit norm.
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
  const attitude = (k) => {
    const p = a.slice(k, k + 4), q = b.slice(k, k + 4);
    const sign = p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3] < 0 ? -1 : 1;
    const m = p.map((x, n) => x + (sign * q[n] - x) * share), size = Math.hypot(...m);
    return m.map((x) => x / size);
  };
  return {
    x: [mix(1, 4), mix(11, 14)], q: [attitude(4), attitude(14)], w: [mix(8, 11), mix(18, 21)],
    h: mix(21, 24), nutation: a.length > 24 && b.length > 24 ? mix(24, 25)[0] : null,
  };
}

const radius = data.boxes.map((box) => norm(box.sides) / 2);
// What has to be seen: boxes and the points of the springs.
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
const most = Math.max(...frames.map((f) => norm(f.slice(21, 24)))) || 1;
let yaw = 0.9, pitch = 0.32, zoom = 1, time = 0, playing = true, before = null;
// One that fails has no start.
const isPushing = (spring) => spring.from !== null && time >= spring.from && (spring.free === null || time < spring.free);

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
  const scale = zoom * Math.min(0.94 * height / (lift - sink), 0.47 * width / wide) || 1;
  const middle = (lift + sink) / 2;
  const point = (v) => { const p = view(v); return [width / 2 + p[0] * scale, height / 2 - (p[1] - middle) * scale, p[2]]; };
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
  data.boxes.forEach((box, i) => {
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
    const arm = 0.75 * radius[i];
    axes.forEach((colour, k) => {
      const unit = [0, 0, 0]; unit[k] = arm;
      arrow(now.x[i], turn(now.q[i], unit), colour, 1.6);
    });
  });
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
  data.springs.forEach((spring) => {
    const a = add(now.x[1], turn(now.q[1], spring.s)), b = add(now.x[0], turn(now.q[0], spring.p));
    const p = point(a), q = point(b), pushes = isPushing(spring);
    things.push({ depth: (p[2] + q[2]) / 2, draw() {
      pen.fillStyle = INK;
      [p, q].forEach((o) => { pen.beginPath(); pen.arc(o[0], o[1], 2.2, 0, 7); pen.fill(); });
      if (!pushes) return;
      const x = q[0] - p[0], y = q[1] - p[1], size = Math.hypot(x, y) || 1, wave = Math.min(7, 0.3 * size + 2);
      pen.strokeStyle = SPRING; pen.lineWidth = 2.4; pen.beginPath(); pen.moveTo(p[0], p[1]);
      for (let k = 1; k < 10; k++) {
        const side = (k % 2 ? 1 : -1) * wave, share = k / 10;
        pen.lineTo(p[0] + x * share - y / size * side, p[1] + y * share + x / size * side);
      }
      pen.lineTo(q[0], q[1]); pen.stroke();
    } });
  });
  things.sort((a, b) => a.depth - b.depth).forEach((thing) => thing.draw());
  // Inertial axes in the corner, and a rule.
  const corner = [46, height - 46];
  axes.forEach((colour, k) => {
    const unit = [0, 0, 0]; unit[k] = 26;
    const v = view(unit);
    pen.strokeStyle = "#8c8c8c"; pen.lineWidth = 1.2; pen.beginPath(); pen.moveTo(...corner);
    pen.lineTo(corner[0] + v[0], corner[1] - v[1]); pen.stroke();
    pen.fillStyle = "#5b6675"; pen.font = "11px system-ui, sans-serif"; pen.textAlign = "center";
    pen.fillText(k + 1, corner[0] + 1.35 * v[0], corner[1] - 1.35 * v[1] + 4);
  });
  pen.textAlign = "left";
  pen.fillText("inertial", 12, height - 8);
  const decade = 10 ** Math.floor(Math.log10(120 / scale)), metres = [5, 2, 1].find((m) => m * decade * scale < 130) * decade;
  pen.strokeStyle = "#5b6675"; pen.beginPath();
  const right = width - 16, low = height - 16;
  pen.moveTo(right - metres * scale, low - 4); pen.lineTo(right - metres * scale, low); pen.lineTo(right, low); pen.lineTo(right, low - 4); pen.stroke();
  pen.textAlign = "right"; pen.fillText(`${+metres.toPrecision(2)} m`, right, low - 8);

  const pushing = data.springs.filter(isPushing).length;
  el("clock").textContent = `${time.toFixed(end < 1 ? 5 : 3)} of ${end.toFixed(end < 1 ? 5 : 3)} s`;
  el("time").value = end > 0 ? 1000 * time / end : 0;
  const rate = (w) => w.map((x) => x.toFixed(4).replace("-", "−")).join(", ");
  const away = norm(add(now.x[0], times(now.x[1], -1)));
  const rows = [
    ["springs that push", `${pushing} of ${data.springs.length}`],
    ["distance of the mass centres", `${away.toFixed(4)} m`],
    ["payload rates 1, 2, 3", `${rate(now.w[0])} deg/s`],
    ["stage rates 1, 2, 3", `${rate(now.w[1])} deg/s`],
    ...(data.closest ? [["clearance", data.closest.d > 0 ? `${data.closest.d} m at ${data.closest.t} s` : `touch at ${data.closest.t} s`]] : []),
    ["nutation", now.nutation === null ? "–" : `${now.nutation.toFixed(4)}°`],
  ];
  const table = el("now");
  while (table.rows.length < rows.length) { const row = table.insertRow(); row.append(document.createElement("th")); row.insertCell(); }
  rows.forEach((row, i) => row.forEach((text, k) => { table.rows[i].cells[k].textContent = text; }));
}

// Springs in eight seconds at first, the coast a tenth as slow as needed.
const speeds = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 50, 100];
const wanted = Math.min(end / 10, Math.max(last / 2, end / 60));
let speed = speeds.reduce((a, b) => (Math.abs(Math.log(b / wanted)) < Math.abs(Math.log(a / wanted)) ? b : a));
speeds.forEach((s) => el("speed").append(new Option(`× ${s}`, s, false, s === speed)));
el("speed").onchange = () => { speed = +el("speed").value; };
function play(on) { playing = on; el("play").textContent = on ? "Pause" : "Play"; before = null; }
el("play").onclick = () => { if (!playing && time >= end) time = 0; play(!playing); };
el("time").oninput = () => { time = el("time").value / 1000 * end; play(false); draw(); };
document.onkeydown = (event) => {
  if (event.code === "Space" && !["BUTTON", "SELECT"].includes(event.target.tagName)) { event.preventDefault(); el("play").click(); }
};
const held = new Map();
canvas.onpointerdown = (event) => { canvas.setPointerCapture(event.pointerId); held.set(event.pointerId, [event.clientX, event.clientY]); };
canvas.onpointermove = (event) => {
  const was = held.get(event.pointerId);
  if (!was) return;
  yaw -= (event.clientX - was[0]) * 0.008;
  pitch = Math.max(-1.57, Math.min(1.57, pitch + (event.clientY - was[1]) * 0.008));
  held.set(event.pointerId, [event.clientX, event.clientY]); draw();
};
canvas.onpointerup = canvas.onpointercancel = (event) => held.delete(event.pointerId);
canvas.addEventListener("wheel", (event) => { event.preventDefault(); zoom = Math.max(0.1, Math.min(20, zoom * Math.exp(-event.deltaY * 0.0015))); draw(); }, { passive: false });
window.onresize = draw;
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
