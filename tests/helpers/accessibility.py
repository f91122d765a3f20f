"""Scripts that look in a page for what cannot be read or has no name, after WCAG 2.2."""

TEXT_OF_POOR_CONTRAST = """() => {
  const linear = (v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4);
  const light = (colour) => {
    const [r, g, b] = colour.match(/[\\d.]+/g).map((v) => linear(v / 255));
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = (element) => {
    for (; element; element = element.parentElement) {
      const colour = getComputedStyle(element).backgroundColor;
      if (!/, 0\\)$|transparent/.test(colour)) return colour;
    }
    return "rgb(255, 255, 255)";
  };
  const hasText = (element) => [...element.childNodes].some((node) => node.nodeType === 3 && node.textContent.trim());
  const contrast = (element) => {
    const [a, b] = [getComputedStyle(element).color, ground(element)].map(light).sort((x, y) => y - x);
    return (a + 0.05) / (b + 0.05);
  };
  return [...document.querySelectorAll("body *")]
    .filter((element) => element.checkVisibility() && hasText(element) && contrast(element) < 4.5)
    .map((element) => element.outerHTML.slice(0, 120));
}"""
CONTROLS_WITHOUT_NAME = """() => [...document.querySelectorAll("button, input, select, canvas, [role=button]")]
  .filter((element) => element.tagName === "SELECT" || !element.textContent.trim())
  .filter((element) => !element.labels?.length && !element.getAttribute("aria-label"))
  .map((element) => element.outerHTML)"""
