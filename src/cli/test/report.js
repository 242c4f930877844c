"use strict";
(() => {
  const all = (selector, root = document) => [...root.querySelectorAll(selector)];
  const clamp = (v, low, high) => Math.min(Math.max(v, low), high);
  // Twice a second each picture, where motion is welcome; otherwise each press of the key shows the other one.
  const still = matchMedia("(prefers-reduced-motion: reduce)");
  const HALF_PERIOD = 250;
  const LARGEST = 32;
  const views = new Map();

  class View {
    constructor(root) {
      this.root = root;
      this.stage = root.querySelector(".stage");
      this.frame = root.querySelector(".frame");
      this.handle = root.querySelector(".handle");
      this.caption = root.querySelector(".caption");
      this.width = Number(root.dataset.width);
      this.height = Number(root.dataset.height);
      this.timer = 0;
      root.style.setProperty("--w", this.width);
      root.style.setProperty("--h", this.height);
      this.fit();
      for (const button of all("[data-set]", root)) {
        button.addEventListener("click", () => this.show(button.dataset.set));
      }
      for (const button of all("[data-zoom]", root)) {
        button.addEventListener("click", () => this.zoomBy(button.dataset.zoom));
      }
      root.querySelector("[data-outline]")?.addEventListener("click", () => this.outline());
      if (this.handle) {
        this.slide(50);
        this.stage.addEventListener("pointerdown", event => this.grab(event));
        this.stage.addEventListener("pointermove", event => this.drag(event));
        this.handle.addEventListener("keydown", event => this.step(event));
      }
      this.say();
    }

    get mode() { return this.root.dataset.mode; }

    show(mode) {
      const button = this.root.querySelector(`[data-set="${mode}"]`);
      if (!button) return;
      if (mode === "blink" && this.mode === "blink") {
        if (still.matches) { this.turn(); return; }
        mode = "slider";
      }
      clearInterval(this.timer);
      this.root.classList.remove("now");
      const changesRoom = (mode === "side") !== (this.mode === "side");
      this.root.dataset.mode = mode;
      if (changesRoom && this.fitted) this.fit();
      for (const other of all("[data-set]", this.root)) {
        other.setAttribute("aria-pressed", String(other.dataset.set === mode));
      }
      if (mode === "blink" && !still.matches) this.timer = setInterval(() => this.turn(), HALF_PERIOD);
      this.say();
    }

    turn() {
      this.root.classList.toggle("now");
      this.say();
    }

    /** Names what is seen, below the pictures. */
    say() {
      const captioned = name => this.root.querySelector(`figure.${name}`)?.dataset.caption ?? "";
      const spans = texts => this.caption.replaceChildren(...texts.map(text => {
        const span = document.createElement("span");
        span.textContent = text;
        return span;
      }));
      switch (this.mode) {
        case "slider": spans([captioned("expected"), captioned("actual")]); break;
        case "blink": {
          const seen = captioned(this.root.classList.contains("now") ? "actual" : "expected");
          spans([still.matches ? `${seen} (b for the other)` : seen]);
          break;
        }
        default: spans([captioned(this.mode)]);
      }
      if (this.mode === "heat") {
        const scale = document.createElement("span");
        scale.className = "scale";
        scale.append(document.createElement("span"));
        this.caption.append(scale);
      }
    }

    slide(percent) {
      const cut = Math.round(clamp(percent, 0, 100) * 10) / 10;
      this.cut = cut;
      this.root.style.setProperty("--cut", cut);
      this.handle.setAttribute("aria-valuenow", String(Math.round(cut)));
      this.handle.setAttribute("aria-valuetext", `${Math.round(cut)} % expected`);
    }

    grab(event) {
      if (this.mode !== "slider" || event.button !== 0) return;
      this.stage.setPointerCapture(event.pointerId);
      this.handle.focus({ preventScroll: true });
      event.preventDefault();
      this.drag(event);
    }

    drag(event) {
      if (this.mode !== "slider" || !this.stage.hasPointerCapture(event.pointerId)) return;
      const box = this.stage.getBoundingClientRect();
      this.slide(100 * (event.clientX - box.left) / box.width);
    }

    step(event) {
      const by = event.shiftKey ? 10 : 1;
      const to = {
        ArrowLeft: this.cut - by, ArrowDown: this.cut - by, ArrowRight: this.cut + by, ArrowUp: this.cut + by,
        PageDown: this.cut - 10, PageUp: this.cut + 10, Home: 0, End: 100,
      }[event.key];
      if (to === undefined || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      this.slide(to);
    }

    /** Pixels of the screen that there are for a picture. */
    room() {
      const style = getComputedStyle(this.frame);
      const across = parseFloat(style.paddingLeft) + parseFloat(style.paddingRight);
      const width = this.frame.clientWidth - across;
      const gap = parseFloat(getComputedStyle(this.stage).columnGap) || 0;
      return [this.mode === "side" ? (width - gap) / 2 : width, innerHeight * 0.72 - across];
    }

    zoom(zoom) {
      this.fitted = false;
      this.factor = clamp(zoom, 1 / 16, LARGEST);
      this.root.style.setProperty("--zoom", this.factor);
      this.root.toggleAttribute("data-smooth", this.factor < 1);
      for (const image of all("img", this.stage)) {
        for (const edge of ["width", "height"]) {
          image.style[edge] = `${image.getAttribute(edge) * this.factor}px`;
        }
      }
      const shown = this.factor < 1 ? this.factor.toFixed(2) : String(Math.round(this.factor * 100) / 100);
      this.root.querySelector(".zoom output").textContent = `${shown}×`;
    }

    /** As large as fits, in whole steps, but small pictures no larger than they are easy to see. */
    fit() {
      const [width, height] = this.room();
      const fit = Math.min(width / this.width, height / this.height);
      this.zoom(fit < 1 ? fit : clamp(Math.floor(Math.min(fit, 640 / this.width)), 1, LARGEST));
      this.fitted = true;
    }

    zoomBy(what) {
      if (what === "fit") { this.fit(); return; }
      if (what === "region") { this.zoomToRegion(); return; }
      const [x, y] = [this.frame.scrollLeft + this.frame.clientWidth / 2, this.frame.scrollTop + this.frame.clientHeight / 2];
      const before = this.factor;
      const larger = before < 1 ? before * 2 : Math.floor(before) + Math.max(1, Math.floor(before / 4));
      const smaller = before <= 1 ? before / 2 : Math.ceil(before) - Math.max(1, Math.floor(before / 5));
      this.zoom(what === "in" ? larger : smaller);
      const ratio = this.factor / before;
      this.frame.scrollTo(x * ratio - this.frame.clientWidth / 2, y * ratio - this.frame.clientHeight / 2);
    }

    /** What changed, with a margin, as large as it fits. */
    zoomToRegion() {
      const button = this.root.querySelector('[data-zoom="region"]');
      if (!button) return;
      const [left, top, width, height] = ["left", "top", "width", "height"].map(name => Number(button.dataset[name]));
      const [across, down] = this.room();
      const fit = 0.9 * Math.min(across / width, down / height);
      this.zoom(fit < 1 ? fit : Math.floor(fit));
      const box = this.stage.getBoundingClientRect();
      const frame = this.frame.getBoundingClientRect();
      const offset = [box.left - frame.left + this.frame.scrollLeft, box.top - frame.top + this.frame.scrollTop];
      this.frame.scrollTo(
        offset[0] + (left + width / 2) * this.factor - this.frame.clientWidth / 2,
        offset[1] + (top + height / 2) * this.factor - this.frame.clientHeight / 2,
      );
      // In the middle of the change the handle shows half of it as it was and half as it is.
      if (this.handle) this.slide(100 * (left + width / 2) / this.width);
    }

    outline() {
      const plain = this.root.toggleAttribute("data-plain");
      this.root.querySelector("[data-outline]").setAttribute("aria-pressed", String(!plain));
    }
  }

  const cards = all(".case");
  const items = all(".passed-list li");
  const search = document.querySelector('input[type="search"]');
  const filters = all(".filter");
  let current = null;

  for (const card of cards) {
    const root = card.querySelector(".viewer");
    if (root) views.set(card, new View(root));
    card.addEventListener("focusin", () => choose(card));
    card.addEventListener("pointerdown", () => choose(card));
  }

  /** What the bar at the top hides, so that a case that is gone to stands below it. */
  function measure() {
    const top = document.querySelector(".top");
    const height = getComputedStyle(top).position === "sticky" ? top.offsetHeight : 0;
    document.documentElement.style.setProperty("--top", `${height}px`);
  }
  measure();

  function choose(card) {
    current?.classList.remove("current");
    current = card;
    current?.classList.add("current");
  }

  function filter() {
    const kind = filters.find(button => button.getAttribute("aria-pressed") === "true").dataset.show;
    const text = search.value.trim().toLowerCase();
    const shows = element => element.dataset.name.toLowerCase().includes(text);
    let shown = 0;
    for (const card of cards) {
      card.hidden = !(shows(card) && (kind === "all" || kind === card.dataset.kind));
      shown += !card.hidden;
    }
    for (const item of items) {
      item.hidden = !(shows(item) && (kind === "all" || kind === "passed"));
      shown += !item.hidden;
    }
    const list = document.querySelector(".passed-list");
    if (list) list.hidden = items.every(item => item.hidden);
    document.querySelector(".nothing").hidden = shown > 0;
    if (current?.hidden) choose(null);
  }

  for (const button of filters) {
    button.addEventListener("click", () => {
      for (const other of filters) other.setAttribute("aria-pressed", String(other === button));
      filter();
    });
  }
  search.addEventListener("input", filter);

  function go(by) {
    const visible = cards.filter(card => !card.hidden);
    if (!visible.length) return;
    const at = visible.indexOf(current);
    const card = visible[at < 0 ? (by > 0 ? 0 : visible.length - 1) : clamp(at + by, 0, visible.length - 1)];
    choose(card);
    card.focus({ preventScroll: true });
    card.scrollIntoView({ block: "start", behavior: still.matches ? "auto" : "smooth" });
  }

  /** The view that keys act on: that of the chosen card, or of the first that has one. */
  function view() {
    const card = current ?? cards.find(card => !card.hidden && views.has(card));
    if (card && card !== current) choose(card);
    return views.get(card);
  }

  const keys = {
    j: () => go(1),
    k: () => go(-1),
    s: () => view()?.show("slider"),
    x: () => view()?.show("side"),
    b: () => view()?.show("blink"),
    d: () => view()?.show("difference"),
    h: () => view()?.show("heat"),
    z: () => view()?.zoomToRegion(),
    o: () => { if (view()?.handle) view().outline(); },
    "+": () => view()?.zoomBy("in"),
    "-": () => view()?.zoomBy("out"),
    0: () => view()?.fit(),
    "/": () => search.focus(),
  };
  document.addEventListener("keydown", event => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    if (event.target === search) {
      if (event.key === "Escape") search.blur();
      return;
    }
    const act = keys[event.key];
    if (!act) return;
    event.preventDefault();
    act();
  });
  addEventListener("resize", () => {
    measure();
    for (const view of views.values()) if (view.fitted) view.fit();
  });
})();
