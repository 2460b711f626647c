// Dark and light: the system's choice, unless the button changed it in this browser.

const root = document.documentElement;
const dark = matchMedia("(prefers-color-scheme: dark)");
let chosen = null;

function show() {
  root.dataset.theme = chosen ?? (dark.matches ? "dark" : "light");
}

export function withTheme(button) {
  dark.addEventListener("change", show);
  button.addEventListener("click", () => {
    chosen = root.dataset.theme === "dark" ? "light" : "dark";
    show();
  });
  show();
}
