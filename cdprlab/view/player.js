// Plays a motion from k3d's own time series: nothing is asked of the kernel. Runs where k3d has opened its picture;
// MOTION is filled in by scene.py: title, end [s], times [s], tensions [N] row by row, largest, colors, limits.
(() => {
  const motion = MOTION;
  const instance = K3DInstance, frame = instance.getWorld().targetDOMNode;
  if (frame.querySelector(".cdprlab-play")) return;
  const root = frame.closest(".cdprlab") || document;
  root.querySelectorAll(".cdprlab-still").forEach((still) => { still.style.display = "none"; });
  const bar = document.createElement("div");
  bar.className = "cdprlab-play";
  bar.style.cssText = "position:absolute;left:0;right:0;bottom:0;background:rgba(255,255,255,.9);color:#2D323A;" +
    "font:12px sans-serif;padding:3px 6px;display:flex;flex-wrap:wrap;gap:3px 8px;align-items:center;z-index:1000";
  bar.innerHTML = `<button type="button" aria-label="play">▶</button>
    <input type="range" min="0" max="${motion.end}" step="any" value="0" aria-label="time in seconds" style="flex:1 1 120px">
    <output style="min-width:9em"></output>
    <label>speed <select>${[0.25, 0.5, 1, 2, 4].map((s) => `<option value="${s}"${s === 1 ? " selected" : ""}>${s} ×</option>`)
      .join("")}</select></label>
    <span>tension [N] <b style="color:${motion.colors[0]}">■</b> slack, 0 <i style="display:inline-block;width:90px;height:9px;
      background:linear-gradient(90deg,${motion.colors.slice(1).join(",")})"></i> ${motion.largest}</span>
    <span class="cdprlab-tensions" style="flex:1 1 100%;font:11px monospace"></span>`;
  frame.appendChild(bar);
  const [button, slider, clock, speed] = ["button", "input", "output", "select"].map((tag) => bar.querySelector(tag));
  const words = bar.querySelector(".cdprlab-tensions");
  let now = 0, last = null, playing = false;

  function color(tension) {
    if (!(tension > 0)) return motion.colors[0];
    const scale = motion.colors.slice(1);
    return scale[Math.min(scale.length - 1, Math.floor(tension / motion.largest * scale.length))];
  }

  function show() {
    instance.setTime(now);
    slider.value = now;
    clock.textContent = `t = ${now.toFixed(2)} of ${motion.end.toFixed(2)} s`;
    let row = motion.times.findIndex((time) => time > now + 1e-6) - 1;
    if (row < 0) row = now > 0 ? motion.times.length - 1 : 0;
    words.innerHTML = motion.tensions[row].map((tension, k) =>
      `<b style="color:${color(tension)}">■</b>${k + 1}: ${tension > 0 ? tension : "slack"}`).join("  ") +
      (motion.notes[row] ? `  <b>${motion.notes[row]}</b>` : "");
  }

  function step(tick) {
    if (!playing) return;
    if (!frame.isConnected) { playing = false; return; }
    if (last !== null) {
      now += (tick - last) / 1000 * Number(speed.value);
      (frame.cdprlabFrames = frame.cdprlabFrames || []).push(tick - last);
    }
    last = tick;
    if (now >= motion.end) { now = motion.end; play(false); }
    show();
    requestAnimationFrame(step);
  }

  function play(on) {
    if (on && now >= motion.end) now = 0;
    playing = on;
    last = null;
    button.textContent = on ? "❚❚" : "▶";
    button.setAttribute("aria-label", on ? "pause" : "play");
    if (on) requestAnimationFrame(step);
  }

  button.addEventListener("click", () => play(!playing));
  slider.addEventListener("input", () => { now = Number(slider.value); show(); });
  ["keydown", "pointerdown", "wheel"].forEach((kind) => bar.addEventListener(kind, (event) => event.stopPropagation()));
  // k3d asks what its camera sees as the camera is moved only: names would be missing in a picture of another size.
  instance.on(instance.events.BEFORE_RENDER, () => {
    const camera = instance.getWorld().camera;
    camera.frustum.setFromProjectionMatrix(camera.projectionMatrix.clone().multiply(camera.matrixWorldInverse));
  });
  show();
  new ResizeObserver(() => setTimeout(show, 500)).observe(frame);   // names are set before, so once more
})();
