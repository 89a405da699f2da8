// Draws the charts of a page with D3 from the data beside it: axes, marks, a part enlarged by mouse, finger or keys.
"use strict";
(() => {
  const GAP = {top: 8, right: 14, bottom: 42};
  const LETTER = 6.7;
  const panels = [];
  // What others draw over a panel each time that it is drawn, and do when something is said below it.
  const drawn = [], said = [];

  const minus = text => text.replace(/-/g, "\u2212").replace(/,/g, "");

  function scaleOf(axis, ends) {
    if (axis.kind === "log") return d3.scaleLog().domain(ends);
    if (axis.kind === "dates") return d3.scaleUtc().domain(ends.map(day => day * 864e5));
    return d3.scaleLinear().domain(ends);
  }

  // On screen a day is a date; elsewhere a value stands for itself.
  const placed = (axis, scale) => value => value === null ? NaN : scale(axis.kind === "dates" ? value * 864e5 : value);

  function power(value) {
    if (value >= 1e-3 && value < 1e4) return d3.format("~g")(value);
    const exponent = Math.floor(Math.log10(value) + 1e-9);
    const first = Math.round(value / 10 ** exponent);
    const raised = String(exponent).replace(/[-0-9]/g, c => c === "-" ? "\u207b" : "\u2070\u00b9\u00b2\u00b3\u2074\u2075\u2076\u2077\u2078\u2079"[+c]);
    return (first === 1 ? "10" : first + "\u00b710") + raised;
  }

  function ticksOf(axis, scale, ends, room) {
    if (axis.names) {
      const seen = axis.names.filter(([at]) => at >= ends[0] && at <= ends[1]);
      const every = Math.max(1, Math.ceil(seen.reduce((sum, [, name]) => sum + name.length + 2, 0) * LETTER / room.width));
      const shown = seen.filter((_, i) => i % every === 0);
      const value = at => axis.kind === "dates" ? at * 864e5 : at;
      return shown.map(([at, name]) => [value(at), name]);
    }
    if (axis.kind === "log") {
      const steps = ends[1] > 300 * ends[0] ? [1] : [1, 2, 5];
      const values = [];
      for (let e = Math.floor(Math.log10(ends[0])); e <= Math.ceil(Math.log10(ends[1])); e++)
        for (const step of steps) values.push(step * 10 ** e);
      const inside = values.filter(v => v >= ends[0] * 0.9999 && v <= ends[1] * 1.0001);
      if (inside.length > 1) {
        const every = Math.ceil(inside.length / room.count);
        return inside.filter((_, i) => i % every === 0).map(v => [v, power(v)]);
      }
      const between = d3.scaleLinear().domain(ends);
      return between.ticks(4).map(v => [v, minus(between.tickFormat(4)(v))]);
    }
    const format = scale.tickFormat(room.count);
    return scale.ticks(room.count).map(v => [v, axis.kind === "dates" ? format(v) : minus(format(v))]);
  }

  // Samples at even steps, of sixteen bits each, as the page packed them.
  function unpacked(even) {
    const bytes = atob(even.samples), n = bytes.length / 2;
    const x = new Float64Array(n), y = new Float64Array(n);
    for (let i = 0; i < n; i++) {
      const count = (bytes.charCodeAt(2 * i) | bytes.charCodeAt(2 * i + 1) << 8) << 16 >> 16;
      x[i] = even.from + i * even.step;
      y[i] = count === -32768 ? NaN : even.least + even.unit * (32767 + count);
    }
    return {x, y};
  }

  // Which samples of a line show in a view: all, or of more than the columns hold the extremes of each column.
  function shownOf(m, ends, columns) {
    const last = m.x.length - 1;
    const place = v => Math.min(Math.max(Math.round((v - m.even.from) / m.even.step), 0), last);
    const first = Math.max(place(ends[0]) - 1, 0), stop = Math.min(place(ends[1]) + 2, last + 1);
    const size = Math.floor((stop - first) / columns);
    if (size < 4) return d3.range(first, stop);
    const chosen = [];
    for (let start = first; start < stop; start += size) {
      let low = start, high = start, gap = -1;
      for (let i = start; i < Math.min(start + size, stop); i++) {
        if (Number.isNaN(m.y[i])) gap = i;
        if (m.y[i] < m.y[low] || Number.isNaN(m.y[low])) low = i;
        if (m.y[i] > m.y[high] || Number.isNaN(m.y[high])) high = i;
      }
      chosen.push(...new Set([low, high, ...(gap < 0 ? [] : [gap])].sort((a, b) => a - b)));
    }
    return chosen;
  }

  class Panel {
    constructor(holder, data, height, chart, name) {
      Object.assign(this, {data, height, chart, name});
      for (const mark of data.marks) if (mark.even) Object.assign(mark, unpacked(mark.even));
      this.sayings = data.marks.filter(mark => mark.kind === "box" && mark.said).sort((a, b) => a.x[0] - b.x[0]);
      this.whole = {x: data.x.ends, y: data.y.ends};
      this.ends = {...this.whole};
      const box = d3.select(holder).append("div").attr("class", "panel").style("flex", data.share + " 1 " + 17 * data.share + "rem");
      if (data.title) box.append("p").text(data.title);
      const told = [data.title, data.y.label, data.x.label && "over " + data.x.label].filter(Boolean).join(", ");
      this.svg = box.append("svg").attr("role", "img").attr("tabindex", 0).attr("aria-label", told);
      this.svg.on("dblclick", () => this.reset()).on("keydown", () => this.key(d3.event));
      this.svg.node().addEventListener("touchstart", event => this.drag(event), {passive: true});
      this.box = box.node();
      const tools = box.append("div").attr("class", "tools");
      for (const [sign, words, act] of [
        ["\u2212", "Show more", () => this.move(0, 1.6)],
        ["+", "Enlarge", () => this.move(0, 0.6)],
        ["\u21ba", "Show all", () => this.reset()],
      ]) tools.append("button").attr("type", "button").attr("aria-label", words).attr("title", words).text(sign).on("click", act);
    }

    draw() {
      const width = this.box.clientWidth;
      if (!width) return;
      const {data, height, ends, svg} = this;
      this.width = width;
      svg.selectAll("*").remove();
      svg.attr("viewBox", `0 0 ${width} ${height}`);
      const inner = height - GAP.top - (data.x.label ? GAP.bottom : 22);
      const y = scaleOf(data.y, ends.y).range([inner, 0]);
      const up = ticksOf(data.y, y, ends.y, {width: 1e9, count: Math.max(2, inner / 42)});
      const letters = Math.max(0, ...up.map(([, text]) => text.length));
      const bare = data.y.names && !data.y.names.length;
      const left = bare ? data.y.label.length * 7.3 + 14 : 26 + letters * LETTER;
      const across = Math.max(width - left - GAP.right, 40);
      const x = scaleOf(data.x, ends.x).range([0, across]);
      const along = ticksOf(data.x, x, ends.x, {width: across, count: Math.max(2, across / 75)});
      const g = svg.append("g").attr("transform", `translate(${left},${GAP.top})`);
      const clip = "clip-" + this.name;
      g.append("clipPath").attr("id", clip).append("rect").attr("width", across).attr("height", inner);
      const lines = g.append("g").attr("class", "grid");
      if (!bare) for (const [v] of up) lines.append("path").attr("d", `M0 ${y(v)}H${across}`);
      for (const [v] of along) lines.append("path").attr("d", `M${x(v)} 0V${inner}`);
      const marks = g.append("g").attr("clip-path", `url(#${clip})`);
      const at = {x: placed(data.x, x), y: placed(data.y, y)};
      for (const mark of data.marks) this.mark(marks, mark, at, across, inner);
      const frame = g.append("g").attr("class", "frame");
      frame.append("path").attr("d", bare ? `M0 ${inner}H${across}` : `M0 0V${inner}H${across}`);
      for (const [v, text] of along)
        frame.append("text").attr("x", x(v)).attr("y", inner + 16).attr("text-anchor", "middle").text(text);
      for (const [v, text] of up)
        frame.append("text").attr("x", -6).attr("y", y(v)).attr("dy", ".32em").attr("text-anchor", "end").text(text);
      const label = frame.append("text").attr("class", "label");
      label.attr("x", across / 2).attr("y", inner + 35).attr("text-anchor", "middle").text(data.x.label);
      const beside = frame.append("text").attr("class", "label").text(data.y.label);
      if (bare) beside.attr("x", -8).attr("y", inner / 2).attr("dy", ".32em").attr("text-anchor", "end");
      else beside.attr("transform", `translate(${14 - left},${inner / 2}) rotate(-90)`).attr("text-anchor", "middle");
      this.across = x;
      this.handle(g, x, y, across, inner);
    }

    mark(g, m, at, across, inner) {
      const color = `var(--${m.color})`;
      const fine = v => Number.isFinite(v);
      if (m.kind === "line") {
        const path = d3.line().x(i => at.x(m.x[i])).y(i => at.y(m.y[i])).defined(i => fine(at.x(m.x[i])) && fine(at.y(m.y[i])));
        g.append("path").attr("d", path(m.even ? shownOf(m, this.ends.x, across) : d3.range(m.x.length))).style("stroke", color).attr("stroke-width", m.width).attr("stroke-dasharray", m.dash || null).attr("opacity", m.alpha).attr("fill", "none");
      } else if (m.kind === "dots") {
        const r = m.size * 0.68;
        let d = "";
        m.x.forEach((v, i) => {
          const [px, py] = [at.x(v), at.y(m.y[i])];
          if (!fine(px) || !fine(py)) return;
          d += m.marker === "s" ? `M${px - r} ${py - r}h${2 * r}v${2 * r}h${-2 * r}z` : `M${px - r} ${py}a${r} ${r} 0 1 0 ${2 * r} 0a${r} ${r} 0 1 0 ${-2 * r} 0`;
        });
        g.append("path").attr("d", d).style("fill", m.hollow ? "var(--page)" : color).style("stroke", color).attr("stroke-width", m.hollow ? 1.1 : 0);
      } else if (m.kind === "band") {
        const [along, over] = m.across ? [at.y, at.x] : [at.x, at.y];
        const value = (list, i) => over(list[i]);
        const area = d3.area().defined((_, i) => fine(along(m.at[i])) && fine(value(m.low, i)) && fine(value(m.high, i)));
        if (m.across) area.y((_, i) => along(m.at[i])).x0((_, i) => value(m.low, i)).x1((_, i) => value(m.high, i));
        else area.x((_, i) => along(m.at[i])).y0((_, i) => value(m.low, i)).y1((_, i) => value(m.high, i));
        g.append("path").attr("d", area(m.at)).style("fill", color).attr("opacity", m.alpha);
      } else if (m.kind === "rule") {
        const place = (m.upright ? at.x : at.y)(m.at);
        if (fine(place)) g.append("path").attr("d", m.upright ? `M${place} 0V${inner}` : `M0 ${place}H${across}`).style("stroke", color).attr("stroke-width", m.width).attr("stroke-dasharray", m.dash || null);
      } else if (m.kind === "box") {
        const [x0, x1] = m.x ? m.x.map(at.x) : [0, across];
        const [y1, y0] = m.y ? m.y.map(at.y) : [inner, 0];
        if (fine(x1 - x0) && fine(y1 - y0)) g.append("rect").attr("x", Math.min(x0, x1)).attr("y", Math.min(y0, y1)).attr("width", Math.max(Math.abs(x1 - x0), 1)).attr("height", Math.max(Math.abs(y1 - y0), 1)).style("fill", color).attr("opacity", m.alpha);
      } else if (m.kind === "note") {
        const [px, py] = [at.x(m.x), at.y(m.y)];
        if (fine(px) && fine(py)) g.append("text").attr("class", "label").attr("x", px + (m.above ? 0 : 7)).attr("y", py - (m.above ? 4 : 0)).attr("text-anchor", m.above ? "middle" : "start").style("fill", color).text(m.text);
      }
    }

    // A part is marked by the mouse. A finger scrolls the page; across an enlarged panel it moves along.
    handle(g, x, y, across, inner) {
      const read = g.append("text").attr("class", "read").attr("x", across).attr("y", 8).attr("text-anchor", "end");
      const brush = d3.brush().extent([[0, 0], [across, inner]]).filter(() => !d3.event.button && d3.event.type !== "touchstart");
      const layer = g.append("g").attr("class", "brush");
      brush.on("end", () => {
        const chosen = d3.event.selection;
        if (!chosen || !d3.event.sourceEvent) return;
        const [[x0, y0], [x1, y1]] = chosen;
        layer.call(brush.move, null);
        if (x1 - x0 < 6 && y1 - y0 < 6) return;
        const days = this.data.x.kind === "dates" ? 864e5 : 1;
        if (x1 - x0 > 12 || y1 - y0 < 12) this.show("x", [x.invert(x0) / days, x.invert(x1) / days]);
        if (y1 - y0 > 12) this.show("y", [y.invert(y1), y.invert(y0)]);
        redraw();
      });
      layer.call(brush);
      const digits = d3.format(".4~g");
      layer.on("mousemove", () => {
        const [px, py] = d3.mouse(g.node());
        this.say(this.sayings.find(box => px >= x(box.x[0]) && px <= x(box.x[1])));
        const inside = px >= 0 && px <= across && py >= 0 && py <= inner;
        const first = this.data.x.kind === "dates" ? d3.utcFormat("%Y-%m-%d")(x.invert(px)) : minus(digits(x.invert(px)));
        read.text(inside ? `${first}, ${minus(digits(y.invert(py)))}` : "");
      }).on("mouseleave", () => read.text(""));
      for (const draw of drawn) draw(this, {g, x, y, across, inner});
    }

    // The finger that touches moves what is enlarged; what it touched is drawn anew meanwhile, and yet hears of it.
    drag(event) {
      const enlarged = this.ends.x[0] !== this.whole.x[0] || this.ends.x[1] !== this.whole.x[1];
      if (!enlarged || event.touches.length !== 1 || !event.target.closest(".brush")) return;
      const begun = event.touches[0].clientX, fresh = this.across.copy(), days = this.data.x.kind === "dates" ? 864e5 : 1;
      const follow = moved => {
        const by = begun - moved.touches[0].clientX;
        this.show("x", fresh.range().map(edge => fresh.invert(edge + by) / days));
        soon();
      };
      event.target.addEventListener("touchmove", follow, {passive: true});
    }

    // What is known of a piece that is pointed at, below all panels of the chart.
    say(box) {
      if (!box || this.chart.told === box) return;
      this.chart.told = box;
      this.chart.saying.text(box.said);
      for (const hear of said) hear(this, box);
    }

    show(axis, ends) {
      this.ends = {...this.ends, [axis]: ends};
      if (axis === "x" && this.chart.linked)
        for (const other of panels) if (other.chart === this.chart && other.data.x.label === this.data.x.label) other.ends = {...other.ends, x: ends};
    }

    reset() {
      this.show("x", this.whole.x);
      this.ends = {...this.whole};
      redraw();
    }

    // Along an axis by a part of what is shown, and to so many times as much.
    move(by, times, axis = "x") {
      const log = this.data[axis].kind === "log";
      const [low, high] = log ? this.ends[axis].map(Math.log10) : this.ends[axis];
      const middle = (low + high) / 2 + by * (high - low), half = (high - low) / 2 * times;
      const ends = [middle - half, middle + half];
      this.show(axis, log ? ends.map(v => 10 ** v) : ends);
      redraw();
    }

    key(event) {
      if (event.target !== this.svg.node() || event.ctrlKey || event.metaKey || event.altKey) return;
      const moves = {ArrowLeft: [-0.2, 1], ArrowRight: [0.2, 1], "+": [0, 0.6], "=": [0, 0.6], "-": [0, 1.6]};
      const tall = {ArrowUp: [0, 0.6, "y"], ArrowDown: [0, 1.6, "y"]};
      const up = this.ends.y === this.whole.y ? {} : {ArrowUp: [0.2, 1, "y"], ArrowDown: [-0.2, 1, "y"]};
      const move = moves[event.key] || (event.shiftKey ? tall : up)[event.key];
      if (event.key === "0" || event.key === "Escape") this.reset();
      if (event.key === "Enter" && this.sayings.length) {
        const step = event.shiftKey ? -1 : 1, place = this.sayings.indexOf(this.chart.told);
        this.say(this.sayings[place < 0 ? 0 : (place + step + this.sayings.length) % this.sayings.length]);
        event.preventDefault();
      }
      if (!move) return;
      event.preventDefault();
      this.move(...move);
    }
  }

  let waits = false;
  function soon() {
    if (waits) return;
    waits = true;
    requestAnimationFrame(() => { waits = false; redraw(); });
  }

  function redraw() {
    for (const panel of panels) panel.draw();
  }

  for (const chart of JSON.parse(document.getElementById("charts").textContent)) {
    const figure = document.querySelector(`[data-chart="${chart.key}"]`);
    const holder = figure.querySelector(".panels");
    chart.rows.forEach((row, i) => {
      const line = document.createElement("div");
      line.className = "row";
      holder.appendChild(line);
      row.forEach((data, j) => panels.push(new Panel(line, data, chart.heights[i], chart, `${chart.key}-${i}-${j}`)));
    });
    const speaks = chart.rows.some(row => row.some(data => data.marks.some(mark => mark.kind === "box" && mark.said)));
    if (speaks) chart.saying = d3.select(holder).append("p").attr("class", "saying").attr("aria-live", "polite")
      .text("Point at a shaded piece, or tap it, to read what it is; with the keyboard Enter on the picture goes from piece to piece.");
    for (const numbers of figure.querySelectorAll("details.numbers")) numbers.open = false;
  }
  redraw();
  // In the next frame: what is drawn within the notice changes sizes again, of which a browser complains.
  new ResizeObserver(() => requestAnimationFrame(() => {
    for (const panel of panels) if (panel.box.clientWidth !== panel.width) panel.draw();
  })).observe(document.querySelector("main"));
  for (const folded of document.querySelectorAll("details")) folded.addEventListener("toggle", redraw);
  const hint = document.querySelector("figure .hint");
  if (hint) hint.hidden = false;
  window.dashpotCharts = {panels, drawn, said, redraw};
  // On paper everything is unfolded; what was drawn is lines and text, which a printer takes as they are.
  addEventListener("beforeprint", () => {
    for (const folded of document.querySelectorAll("details.more")) folded.open = true;
    redraw();
  });
})();
