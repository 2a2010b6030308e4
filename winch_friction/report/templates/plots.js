(() => {
  "use strict";
  // colours that people with any colour vision tell apart; dashes keep them apart in print
  const LIGHT = {ink: "#1d2126", faint: "#59616b", grid: "#e3e5e8", card: "#ffffff", measured: "#1d2126", before: "#b34700",
    after: "#0062a3", noise: "#59616b", truth: "#8a8f96", other: "#8d939a", low: "#0062a3", high: "#b34700", mid: "#f4f4f2",
    plain: ["#0062a3", "#b34700", "#00754f", "#9c3d7a", "#5b4db3", "#806600", "#2d7f94", "#a03d38"]};
  const DARK = {ink: "#e4e7ea", faint: "#a3adb8", grid: "#343b43", card: "#1c2025", measured: "#f2f4f6", before: "#ffa25c",
    after: "#62b8f5", noise: "#a3adb8", truth: "#8b949e", other: "#68727d", low: "#62b8f5", high: "#ffa25c", mid: "#2a3037",
    plain: ["#62b8f5", "#ffa25c", "#5fd0a0", "#e08fc4", "#a99cf0", "#d6b94a", "#7cc7da", "#ef918b"]};
  const DASH = {before: "6px,3px", noise: "2px,3px", truth: "solid", measured: "solid", after: "solid"};
  const WIDTH = {measured: 1.6, before: 1.4, after: 1.8, truth: 3, noise: 1.2, other: 1};
  const HATCH = ["", "/", "x", "."];  // what dashes are to lines: areas beyond the colours
  const CYCLE = ["solid", "7px,3px", "2px,2px", "7px,3px,2px,3px"];
  const dark = matchMedia("(prefers-color-scheme: dark)"), paper = matchMedia("print");
  const narrow = () => innerWidth < 560;
  const look = () => (dark.matches && !paper.matches ? DARK : LIGHT);
  const still = matchMedia("(prefers-reduced-motion: reduce)");

  const numbers = (packed) => {
    if (Array.isArray(packed)) return packed;
    const bytes = Uint8Array.from(atob(packed), (c) => c.charCodeAt(0));
    return new Float32Array(bytes.buffer);
  };
  const figures = [...document.querySelectorAll("figure.plot")].map((figure) => {
    const content = JSON.parse(figure.querySelector("script").textContent);
    for (const frame of content.frames)
      for (const label in frame.columns) frame.columns[label] = numbers(frame.columns[label]);
    for (const heat of content.heats) {
      heat.x = numbers(heat.x); heat.y = numbers(heat.y); heat.z = heat.z.map((row) => Array.from(numbers(row)));
    }
    return {figure, canvas: figure.querySelector(".canvas"), content, drawn: false};
  });

  const shown = (v) => (typeof v === "string" ? `"${v.replaceAll('"', '""')}"` : Number.isFinite(v) ? String(+v.toPrecision(7)) : "");
  const csv = ({frames, heats}) => {
    if (heats.length) {
      const rows = [["panel", heats[0].xl, heats[0].yl, heats[0].unit].map(shown).join(",")];
      for (const h of heats) h.z.forEach((row, j) => row.forEach((v, i) => {
        if (Number.isFinite(v)) rows.push([h.title, h.x[i], h.y[j], v].map(shown).join(","));
      }));
      return rows.join("\n") + "\n";
    }
    const labels = [...new Set(frames.flatMap((f) => Object.keys(f.columns)))], several = frames.length > 1;
    const rows = [(several ? ["data", ...labels] : labels).map(shown).join(",")];
    for (const f of frames) {
      const length = Math.max(...Object.values(f.columns).map((c) => c.length));
      for (let i = 0; i < length; i++) {
        const cells = labels.map((l) => (f.columns[l] ? shown(f.columns[l][i]) : ""));
        rows.push((several ? [shown(f.name), ...cells] : cells).join(","));
      }
    }
    return rows.join("\n") + "\n";
  };
  const offer = (each) => {
    each.figure.querySelector("a.csv").href = "data:text/csv;charset=utf-8," + encodeURIComponent(csv(each.content));
  };
  for (const each of figures)
    for (const event of ["pointerenter", "focus", "click", "touchstart"])
      each.figure.querySelector("a.csv").addEventListener(event, () => offer(each), {passive: true});

  const traces = (content, c) => {
    let next = 0;
    const legends = new Set();
    const axis = (row) => (row ? String(row + 1) : "");
    // what was measured lies as a broad shadow under the models, so that both show where they agree
    const shadowed = (row) => content.lines.some((line) => line[4] === row && line[5] === "after");
    return content.lines.map(([label, x, y, frame, row, role, kind, upper, like]) => {
      const columns = content.frames[frame].columns, k = role !== "plain" ? 0 : like >= 0 ? like : next++;
      const colour = role === "plain" ? c.plain[k % c.plain.length] : c[role];
      const dash = role === "plain" ? CYCLE[Math.floor(k / c.plain.length) % CYCLE.length] : DASH[role] || "solid";
      const first = !legends.has(label) && label !== "";
      legends.add(label);
      const base = {x: columns[x], y: columns[y], name: label, legendgroup: label, showlegend: first, xaxis: "x",
        yaxis: "y" + axis(row), hovertemplate: "%{y:.4g}<extra>" + label + "</extra>"};
      if (kind === "bars")
        return {...base, type: "bar", marker: {color: colour, line: {color: colour, width: 1},
          pattern: role === "before" ? {shape: "/", fillmode: "replace", fgcolor: colour, bgcolor: c.card, size: 6} : {shape: ""}}};
      if (kind === "dots") return {...base, type: "scatter", mode: "markers", marker: {color: colour, size: 5}};
      const below = kind === "area" && columns[y].reduce((sum, each) => sum + each, 0) < 0;  // a stack of its own under zero
      if (kind === "area") return {...base, type: "scatter", mode: "lines", stackgroup: (below ? "under" : "row") + row, line: {color: colour, width: 0.5},
        fillcolor: colour + "90", fillpattern: {shape: HATCH[Math.floor(k / c.plain.length) % HATCH.length], fgcolor: c.card, bgcolor: colour + "90", size: 7, solidity: 0.35}};
      if (kind === "band") {
        const there = Array.from(columns[x]), back = there.slice().reverse();
        return {...base, x: there.concat(back), y: Array.from(columns[upper]).concat(Array.from(columns[y]).reverse()),
          type: "scatter", mode: "lines", line: {width: 0}, fill: "toself", fillcolor: colour + "33", hoverinfo: "skip", hovertemplate: undefined};
      }
      const shadow = role === "measured" && shadowed(row);
      return {...base, type: "scatter", mode: "lines", connectgaps: false, opacity: shadow ? 0.4 : 1,
        line: {color: colour, width: shadow ? 5 : WIDTH[role] || 1.5, dash}};
    });
  };

  const axisLook = (c) => ({gridcolor: c.grid, zerolinecolor: c.grid, linecolor: c.faint, tickfont: {color: c.ink},
    automargin: true, exponentformat: "power", title: {font: {color: c.ink, size: narrow() ? 12 : 13}, standoff: 8}});
  const layout = (content, c) => {
    const rows = Math.max(content.rows.length, 1), made = {
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)", font: {color: c.ink, size: narrow() ? 11 : 13, family: "system-ui, sans-serif"},
      margin: {l: narrow() ? 52 : 66, r: 12, t: 10, b: 48}, hovermode: "x unified", hoverlabel: {bgcolor: c.card, bordercolor: c.faint, font: {color: c.ink}},
      legend: {orientation: "h", y: 1.0, yanchor: "bottom", x: 0, font: {color: c.ink}, itemsizing: "constant", maxheight: 4000}, barmode: "group", dragmode: narrow() ? false : "zoom",
      modebar: {bgcolor: "rgba(0,0,0,0)", color: c.faint, activecolor: c.ink}};
    const gap = Math.min(0.05, 0.2 / rows), height = (1 - gap * (rows - 1)) / rows;
    for (let row = 0; row < rows; row++) {
      const top = 1 - row * (height + gap), title = content.rows[row] || "";
      made["yaxis" + (row ? row + 1 : "")] = {...axisLook(c), domain: [Math.max(0, top - height), top],
        title: {...axisLook(c).title, text: narrow() || rows > 3 ? title.replace(/ \[/, "<br>[") : title}};
    }
    made.xaxis = {...axisLook(c), anchor: "y" + (rows > 1 ? rows : ""), title: {...axisLook(c).title, text: content.x}};
    return made;
  };

  const drawHeats = (content, c) => {
    const count = content.heats.length, width = (1 - 0.08 * (count - 1)) / count, stack = narrow() && count > 1;
    const peak = Math.max(...content.heats.flatMap((h) => h.z.flat().filter(Number.isFinite).map(Math.abs)), 1e-12);
    const made = {...layout({rows: [""], x: ""}, c), annotations: [], hovermode: "closest", margin: {l: 66, r: 12, t: 40, b: 52}};
    delete made.xaxis; delete made.yaxis;
    const data = content.heats.map((h, k) => {
      const id = k ? String(k + 1) : "", left = k * (width + 0.08), high = stack ? 1 - k * 0.56 : 1;
      made["xaxis" + id] = {...axisLook(c), domain: stack ? [0, 1] : [left, left + width], anchor: "y" + id,
        title: {...axisLook(c).title, text: stack && k === 0 ? "" : h.xl}};
      made["yaxis" + id] = {...axisLook(c), domain: stack ? [Math.max(0, high - 0.44), high] : [0, 1], anchor: "x" + id,
        title: {...axisLook(c).title, text: k && !stack ? "" : h.yl}};
      made.annotations.push({text: h.title, showarrow: false, x: stack ? 0 : left, y: high, xref: "paper", yref: "paper", yanchor: "bottom", xanchor: "left", font: {color: c.ink}});
      return {type: "heatmap", x: h.x, y: h.y, z: h.z, xaxis: "x" + id, yaxis: "y" + id, zmin: -peak, zmax: peak, xgap: 1, ygap: 1,
        colorscale: [[0, c.low], [0.5, c.mid], [1, c.high]], showscale: k === count - 1, hovertemplate: "%{x:.4g}, %{y:.4g}: %{z:.3g}<extra></extra>",
        colorbar: {title: {text: h.unit, side: "right", font: {color: c.ink}}, tickfont: {color: c.ink}, thickness: 12, outlinewidth: 0}};
    });
    return [data, made];
  };

  const options = {responsive: true, displaylogo: false, displayModeBar: "hover", modeBarButtonsToRemove: ["select2d", "lasso2d", "autoScale2d"]};
  // a legend takes its rows from the picture's height: where it has many, the picture grows
  const grow = (each) => {
    const labels = [...new Set(each.content.lines.map(([label]) => label))], room = Math.max(each.canvas.clientWidth - 80, 150);
    const wide = Math.max(...labels.map((label) => label.length), 1) * 6.6 + 46;
    const rows = labels.length ? Math.ceil(labels.length / Math.max(1, Math.floor(room / wide))) : 0;
    each.tall = each.tall || each.canvas.clientHeight;
    each.canvas.style.height = each.tall + 21 * Math.max(0, rows - 2) + "px";
  };
  const draw = (each) => {
    grow(each);
    const c = look(), heat = each.content.heats.length > 0;
    const [data, made] = heat ? drawHeats(each.content, c) : [traces(each.content, c), layout(each.content, c)];
    if (each.drawn && !heat) {  // a change of theme keeps the zoom
      for (const key of Object.keys(made)) {
        const old = each.canvas.layout && each.canvas.layout[key];
        if (/^[xy]axis/.test(key) && old && old.autorange === false) Object.assign(made[key], {range: old.range.slice(), autorange: false});
      }
    }
    Plotly.react(each.canvas, data, made, options);
    if (!each.drawn) {
      each.drawn = true;
      if (each.content.link) each.canvas.on("plotly_relayout", (change) => follow(each, change));
    }
  };
  let following = false;
  const follow = (source, change) => {
    const low = change["xaxis.range[0]"], high = change["xaxis.range[1]"], all = change["xaxis.autorange"];
    if (following || (low === undefined && !all)) return;
    following = true;
    const update = all ? {"xaxis.autorange": true} : {"xaxis.range": [low, high]};
    const others = figures.filter((f) => f !== source && f.drawn && f.content.link === source.content.link);
    Promise.all(others.map((f) => Plotly.relayout(f.canvas, update))).finally(() => { following = false; });
  };

  const start = () => {
    const seen = new IntersectionObserver((entries) => {
      for (const entry of entries)
        if (entry.isIntersecting) {
          const each = figures.find((f) => f.canvas === entry.target);
          if (!each.drawn) draw(each);
        }
    }, {rootMargin: "400px"});
    for (const each of figures) seen.observe(each.canvas);
    const again = () => figures.filter((f) => f.drawn).forEach(draw);
    dark.addEventListener("change", again);
    addEventListener("beforeprint", () => figures.forEach(draw));
    let waiting = 0, width = innerWidth;
    addEventListener("resize", () => {
      if (innerWidth !== width) { width = innerWidth; clearTimeout(waiting); waiting = setTimeout(again, 200); }
    });
    globalThis.drawEveryPlot = () => { figures.filter((f) => !f.drawn).forEach(draw); return figures.length; };
    document.documentElement.dataset.plots = "ready";
  };
  const unpack = async () => {
    const packed = Uint8Array.from(atob(document.getElementById("plotly").textContent), (ch) => ch.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    const script = document.createElement("script");
    script.textContent = await new Response(stream).text();
    document.head.append(script);
  };
  unpack().then(start).catch((error) => {
    for (const {canvas} of figures) canvas.textContent = "This browser cannot draw the figure; its data are in the CSV below.";
    document.documentElement.dataset.plots = "failed: " + error;
  });
})();
