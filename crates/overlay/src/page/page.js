(() => {
  "use strict";
  const one = (what, from = document) => from.querySelector(what);
  const all = (what, from = document) => [...from.querySelectorAll(what)];
  document.documentElement.classList.add("js");

  const stage = one(".stage");
  if (stage) {
    const chosen = (group) => one(`input[name=${group}]:checked`).value;
    const card = (layout) => one(`.card[data-layout="${layout}"]`);
    const put = (image, from) => {
      image.hidden = !from || !from.src;
      if (image.hidden) return;
      image.src = from.src;
      image.alt = from.alt;
    };
    const show = () => {
      const measure = chosen("measure");
      const option = chosen("option");
      put(one(".before", stage), one(`.v${measure}`, card("present")));
      put(one(".after", stage), one(`.v${measure}`, card(option)));
      one(".sides .right").textContent = one("h3", card(option)).textContent;
      one(".caption").textContent = one(".words", card(option)).textContent;
    };
    const range = one("input", stage);
    const cut = () => stage.style.setProperty("--cut", `${range.value}%`);
    range.addEventListener("input", cut);
    all(".switch").forEach((s) => s.addEventListener("change", show));
    all(".card:not([data-layout=present]) .views").forEach((views) =>
      views.addEventListener("click", () => {
        one(`#option${views.parentElement.dataset.layout}`).checked = true;
        show();
        one(".compare").scrollIntoView({ behavior: "smooth" });
      }));
    cut();
    show();
  }

  const command = one(".command");
  if (command && navigator.clipboard) {
    const button = document.createElement("button");
    button.type = "button";
    button.textContent = "Copy";
    button.addEventListener("click", async () => {
      await navigator.clipboard.writeText(one("code", command).textContent);
      button.textContent = "Copied";
    });
    command.append(button);
  }
})();
