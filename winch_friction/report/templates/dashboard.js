(() => {
  "use strict";
  // the last two minutes of every signal, drawn as they come; EventSource reconnects by itself
  const SPAN = 120, held = {}, panels = [
    {id: "torque", y: "torque [N·m]", signals: [["truth", "truth"], ["feedforward", "after"], ["learned", "before"]]},
    {id: "loop", x: "motor speed [rpm]", y: "torque [N·m]", signals: [["feedforward", "after"], ["learned", "before"]]},
    {id: "speed", y: "motor speed [rpm]", signals: [["reference", "before"], ["speed", "measured"]]},
    {id: "error", y: "position error [mm]", signals: [["error", "after"]]}];
  const words = JSON.parse(document.getElementById("signals").textContent);
  const dark = matchMedia("(prefers-color-scheme: dark)");
  const colours = () => (dark.matches
    ? {ink: "#e4e7ea", grid: "#343b43", measured: "#f2f4f6", before: "#ffa25c", after: "#62b8f5", truth: "#8b949e"}
    : {ink: "#1d2126", grid: "#e3e5e8", measured: "#1d2126", before: "#b34700", after: "#0062a3", truth: "#8a8f96"});
  const text = (id, said) => { const place = document.getElementById(id); if (place.textContent !== said) place.textContent = said; };

  const keep = (points) => {
    for (const name in points) {
      const old = held[name] || (held[name] = []);
      if (old.length && points[name][0][0] < old[old.length - 1][0] - 5) old.length = 0;  // the source began again
      old.push(...points[name]);
      const first = old[old.length - 1][0] - SPAN;
      while (old.length && old[0][0] < first) old.shift();
    }
  };
  const speedAt = (time) => {  // the speed log is in order: bisect
    const log = held.speed || [];
    let low = 0, high = log.length - 1;
    while (low < high) { const mid = (low + high) >> 1; if (log[mid][0] < time) low = mid + 1; else high = mid; }
    return log.length ? log[low][1] : NaN;
  };
  const traces = (panel, c) => panel.signals.filter(([name]) => held[name]).map(([name, role]) => ({
    x: held[name].map((p) => (panel.x ? speedAt(p[0]) : p[0] - held[name][held[name].length - 1][0])), y: held[name].map((p) => p[1]),
    name: words[name].replace(/ \[.*/, ""), mode: panel.x ? "markers" : "lines", type: "scatter", marker: {size: 3, color: c[role]},
    line: {color: c[role], width: role === "truth" ? 4 : 1.6, dash: role === "before" ? "5px,3px" : "solid"}}));
  const draw = () => {
    const c = colours(), axis = {gridcolor: c.grid, zerolinecolor: c.grid, tickfont: {color: c.ink}, automargin: true};
    for (const panel of panels) {
      const data = traces(panel, c), place = document.getElementById(panel.id);
      place.parentElement.hidden = !data.length;
      if (data.length) Plotly.react(place, data, {paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: {color: c.ink, family: "system-ui"},
        margin: {l: 60, r: 10, t: 8, b: 42}, legend: {orientation: "h", y: 1, yanchor: "bottom", font: {color: c.ink}, itemsizing: "constant"}, uirevision: "kept", showlegend: true,
        modebar: {bgcolor: "rgba(0,0,0,0)", color: c.ink, activecolor: c.ink},
        xaxis: {...axis, title: {text: panel.x || "time before now [s]", font: {color: c.ink}}}, yaxis: {...axis, title: {text: panel.y, font: {color: c.ink}}}},
        {responsive: true, displaylogo: false, displayModeBar: "hover", modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"]});
    }
  };
  const fill = (id, rows) => {
    const body = document.getElementById(id), made = rows.map((cells) => {
      const row = document.createElement("tr");
      for (const cell of cells) {
        const place = document.createElement("td");
        String(cell).split(/(?<=[_/])(?=\w)/).forEach((part, k) => place.append(...(k ? [document.createElement("wbr"), part] : [part])));
        row.append(place);
      }
      return row;
    });
    body.replaceChildren(...made);
  };
  const short = (v) => {
    if (!Number.isFinite(v)) return "–";
    const size = Math.abs(v), powers = size && (size < 1e-3 || size >= 1e6);  // as the pages' tables
    return powers ? v.toExponential(3).replace(/\.?0+e/, "e").replace("e-", "e−") : String(+v.toPrecision(4));
  };
  const show = (frame) => {
    keep(frame.points);
    fill("state", frame.state);
    fill("estimates", frame.estimates.map((e) => [e.parameter, short(Math.abs(e.value) < 0.005 * e.std ? 0 : e.value), short(e.value - e.std) + "\u00a0… " + short(e.value + e.std), e.status]));
    fill("inputs", frame.inputs.map((e) => [e.input, short(e.rate), short(e.age)]));
    text("faults", frame.faults.length ? frame.faults.join("; ") : "no fault");
    document.getElementById("faults").className = frame.faults.length ? "bad" : "good";
    if (frame.time !== null) text("time", "time " + frame.time.toFixed(1) + " s");
    document.documentElement.dataset.frames = String(+(document.documentElement.dataset.frames || 0) + 1);
  };
  let drawn = 0;
  const listen = () => {
    const events = new EventSource("events");
    events.onopen = () => { text("link", "connected"); document.documentElement.dataset.link = "open"; };
    events.onerror = () => { text("link", "connection lost, trying again"); document.documentElement.dataset.link = "lost"; };
    events.onmessage = (event) => {
      show(JSON.parse(event.data));
      if (performance.now() - drawn > 400) { drawn = performance.now(); draw(); }
    };
    events.addEventListener("end", () => { draw(); events.close(); text("link", "the source has ended"); document.documentElement.dataset.link = "ended"; });
    dark.addEventListener("change", draw);
  };
  const unpack = async () => {
    const packed = Uint8Array.from(atob(document.getElementById("plotly").textContent), (ch) => ch.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    document.head.append(Object.assign(document.createElement("script"), {textContent: await new Response(stream).text()}));
  };
  unpack().then(listen).catch((error) => text("link", "this browser cannot draw: " + error));
})();
