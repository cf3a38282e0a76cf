// MathJax draws the blocks of mathematics, which have the class arithmatex, and nothing else.
window.MathJax = {
  tex: { displayMath: [["\\[", "\\]"]] },
  chtml: { scale: 0.85 },
  options: { ignoreHtmlClass: ".*", processHtmlClass: "arithmatex", enableMenu: false },
};
