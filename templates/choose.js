// What a reader chooses with a mouse, a finger or keys, as the option to paste: a part by two cursors, a mode by a click.
"use strict";
(() => {
  const {panels, drawn, said, redraw} = window.dashpotCharts;
  // Columns to which a cursor is placed: as a round number that is no nearer than they are wide.
  const COLUMNS = 400;
  const SAMPLES = 20000;

  const rounded = (value, span, columns) => {
    const step = 10 ** Math.floor(Math.log10(span / columns));
    return Math.round(value / step) * step;
  };
  const text = value => String(+value.toFixed(9));

  function made(parent, tag, words, attributes = {}) {
    const element = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
    element.textContent = words;
    parent.appendChild(element);
    return element;
  }

  async function copied(code, button) {
    const words = button.textContent;
    getSelection().selectAllChildren(code);  // which works in a notebook's frame too, and shows what was copied
    let done = document.execCommand("copy");
    try {
      if (!done) await navigator.clipboard.writeText(code.textContent), done = true;
    } catch {}  // a page that may not write there leaves it selected
    button.textContent = done ? "Copied" : "Selected: copy it";
    setTimeout(() => { button.textContent = words; }, 1500);
  }

  class Choice {
    constructor(holder) {
      this.says = holder.dataset;
      this.time = panels.filter(panel => panel.chart.key === this.says.time);
      this.spectrum = panels.filter(panel => panel.chart.key === this.says.spectrum);
      this.modes = this.spectrum.flatMap(panel => panel.data.marks.filter(mark => mark.choice));
      this.whole = this.time[0].whole.x;
      this.range = [...this.whole];
      this.mode = null;
      this.places = new Map();
      const line = made(holder, "p", "", {class: "cursors"});
      this.inputs = ["From", "to"].map((words, i) => {
        const label = made(line, "label", words + " ");
        const input = made(label, "input", "", {type: "number", step: "any", inputmode: "decimal"});
        input.addEventListener("change", () => this.set(i, Number.isFinite(input.valueAsNumber) ? input.valueAsNumber : this.whole[i], SAMPLES));
        label.append(" s ");
        return input;
      });
      made(line, "button", "What is shown", {type: "button", title: "Put the cursors on the edges of what is enlarged"}).addEventListener("click", () => this.take(this.time[0].ends.x, COLUMNS));
      made(line, "button", "All of it", {type: "button"}).addEventListener("click", () => this.take(this.whole, SAMPLES));
      this.lines = ["part", "mode", "command"].map(name => {
        const shown = made(holder, "p", "", {class: "pasted"});
        const code = made(shown, "code", "");
        const button = made(shown, "button", "Copy", {type: "button"});
        button.addEventListener("click", () => copied(code, button));
        return {name, shown, code, button, words: made(shown, "span", "", {class: "quiet", "aria-live": name === "command" ? "off" : "polite"})};
      });
      drawn.push((panel, view) => this.draw(panel, view));
      said.push((panel, box) => {
        if (panel.chart.key !== this.says.time) return;
        const button = made(panel.chart.saying.node(), "button", "Cursors to this piece", {type: "button"});
        button.addEventListener("click", () => this.take(box.x, SAMPLES));
      });
      this.update();
    }

    take(range, columns) {
      const span = this.whole[1] - this.whole[0];
      const ends = range.map((value, i) => Math.abs(value - this.whole[i]) < span / 1e6 ? this.whole[i] : rounded(value, range[1] - range[0], columns));
      this.range = ends.map(value => Math.min(Math.max(value, this.whole[0]), this.whole[1]));
      this.update();
    }

    set(i, value, columns) {
      const [low, high] = this.time[0].ends.x, least = (high - low) / COLUMNS;
      const edge = i ? Math.max(value, this.range[0] + least) : Math.min(value, this.range[1] - least);
      const kept = Math.min(Math.max(rounded(edge, high - low, columns), this.whole[0]), this.whole[1]);
      this.range = i ? [this.range[0], kept] : [kept, this.range[1]];
      this.update();
    }

    draw(panel, {g, x, across, inner}) {
      if (this.spectrum.includes(panel)) this.buttons(panel, g, x, across, inner);
      if (!this.time.includes(panel)) return;
      const clear = g.append("g").attr("class", "beside");
      const shades = [0, 1].map(() => clear.append("rect").attr("height", inner));
      const cursors = [0, 1].map(i => {
        const cursor = g.append("g").attr("class", "cursor");
        cursor.append("path").attr("class", "line").attr("d", `M0 0V${inner}`);
        cursor.append("rect").attr("x", -14).attr("width", 28).attr("height", 28).attr("y", -6).attr("fill", "none").attr("pointer-events", "all");
        cursor.append("path").attr("class", "grip").attr("d", i ? "M0 0v16l-11 -8z" : "M0 0v16l11 -8z");
        if (panel === this.time[this.time.length - 1]) cursor.attr("tabindex", 0).attr("role", "slider").attr("aria-label", `${i ? "End" : "Start"} of the part, s`);
        cursor.call(d3.drag().container(g.node()).on("drag", () => this.set(i, x.invert(d3.event.x), COLUMNS)));
        cursor.on("keydown", () => this.key(d3.event, i));
        return cursor;
      });
      this.places.set(panel, {x, across, shades, cursors});
      this.place(panel);
    }

    // Moved in place: what is drawn anew would lose the focus of a keyboard.
    place(panel) {
      const {x, across, shades, cursors} = this.places.get(panel);
      const [from, to] = this.range.map(value => Math.min(Math.max(x(value), 0), across));
      shades[0].attr("x", 0).attr("width", from);
      shades[1].attr("x", to).attr("width", Math.max(across - to, 0));
      cursors.forEach((cursor, i) => {
        const at = x(this.range[i]);
        cursor.attr("transform", `translate(${at},0)`).attr("display", at < -1 || at > across + 1 ? "none" : null);
        cursor.attr("aria-valuemin", text(this.whole[0])).attr("aria-valuemax", text(this.whole[1])).attr("aria-valuenow", text(this.range[i]));
      });
    }

    key(event, i) {
      const [low, high] = this.time[0].ends.x, step = (high - low) / (event.shiftKey ? 20 : 200);
      const to = {ArrowLeft: this.range[i] - step, ArrowRight: this.range[i] + step, Home: this.whole[0], End: this.whole[1]}[event.key];
      if (to === undefined) return;
      event.preventDefault();
      this.set(i, to, COLUMNS);
    }

    buttons(panel, g, x, across, inner) {
      this.modes.forEach((mode, i) => {
        const at = x(mode.at);
        if (!(at >= 0 && at <= across)) return;
        const button = g.append("g").attr("class", "choice").attr("transform", `translate(${at},0)`);
        button.attr("tabindex", 0).attr("role", "button").attr("aria-label", mode.said).attr("aria-pressed", this.mode === mode);
        button.append("rect").attr("x", -12).attr("width", 24).attr("height", inner).attr("fill", "none").attr("pointer-events", "all");
        button.append("circle").attr("cy", inner - 12).attr("r", 10);
        button.append("text").attr("y", inner - 12).attr("dy", ".34em").attr("text-anchor", "middle").text(i + 1);
        button.append("title").text(mode.said);
        const choose = () => {
          this.mode = this.mode === mode ? null : mode;
          g.selectAll(".choice").attr("aria-pressed", (_, j, all) => all[j] === button.node() && this.mode === mode);
          this.update();
        };
        button.on("click", choose).on("keydown", () => {
          if (d3.event.key !== "Enter" && d3.event.key !== " ") return;
          d3.event.preventDefault();
          choose();
        });
      });
    }

    get part() {
      const [from, to] = this.range.map(value => text(value));
      const starts = this.range[0] === this.whole[0], ends = this.range[1] === this.whole[1];
      if (starts && ends) return this.says.whole;
      return `${from}:${ends && !this.says.whole ? "" : to}`;
    }

    update() {
      for (const panel of this.places.keys()) this.place(panel);
      this.inputs.forEach((input, i) => { input.value = text(this.range[i]); });
      const filled = (option, value) => value ? option.replace("{}", value) : "";
      const part = filled(this.says.part, this.part), mode = filled(this.says.mode, this.mode && this.mode.choice);
      const length = this.range[1] - this.range[0];
      const words = {
        part: part ? ` ${text(rounded(length, length, 1000))} s of ${text(rounded(this.whole[1] - this.whole[0], length, 1000))} s` : "The cursors stand at the ends: all of it, which needs no option.",
        mode: mode ? ` ${this.mode.said}` : this.says.modes,
        command: "",
      };
      const texts = {part, mode, command: this.says.command.replace("{}", [part, mode].filter(Boolean).map(option => this.says.join + " " + option).join(""))};
      for (const {name, shown, code, button, words: beside} of this.lines) {
        code.textContent = texts[name];
        code.hidden = button.hidden = !texts[name];
        beside.textContent = words[name];
        shown.hidden = !texts[name] && !words[name];
      }
    }
  }

  for (const holder of document.querySelectorAll(".chosen")) new Choice(holder);
  redraw();
  // Within a notebook the frame is as high as what stands in it.
  const fit = () => {
    try {
      if (frameElement) frameElement.style.height = `${document.body.offsetHeight + 60}px`;
    } catch {}  // another page's frame is not ours to change
  };
  new ResizeObserver(() => requestAnimationFrame(fit)).observe(document.body);
})();
