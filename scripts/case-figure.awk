# case-figure.awk: one case's scores as an SVG, on standard output; used by splice-cases.sh.
#
# Input: lines of engine, verdict, error, explained, unexplained, separated by tabs. -v id=ID.
# A row per engine on a logarithmic axis: circle: error against the continuous truth; ring: the part that the
# scheme explains; diamond: what nothing explains. Numbers below 1e-17 stand at the left edge.
BEGIN { FS = "\t"; left = 150; right = 700; top = 34; row = 20; low = -17; high = 1 }
function at(value,   x) {
  x = value + 0 > 0 ? log(value) / log(10) : low
  if (value == "inf" || x > high) x = high
  if (x < low) x = low
  return left + (x - low) / (high - low) * (right - left)
}
{ ++n; engine[n] = $1; verdict[n] = $2; error[n] = $3; explained[n] = $4; unexplained[n] = $5 }
END {
  bottom = top + row * n
  printf "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 720 %d\" width=\"720\" height=\"%d\" font-family=\"sans-serif\" font-size=\"11\" role=\"img\">\n", bottom + 46, bottom + 46
  printf "<title>%s: error of each engine, and how much of it its scheme explains</title>\n", id
  printf "<rect width=\"720\" height=\"%d\" fill=\"white\"/>\n", bottom + 46
  printf "<text x=\"12\" y=\"18\" font-weight=\"bold\">%s</text>\n", id
  for (d = low + 1; d <= high; d += 2) {
    x = at(10 ^ d)
    printf "<line x1=\"%.1f\" y1=\"%d\" x2=\"%.1f\" y2=\"%d\" stroke=\"#ddd\"/><text x=\"%.1f\" y=\"%d\" text-anchor=\"middle\" fill=\"#555\">1e%d</text>\n", x, top - 6, x, bottom, x, bottom + 14, d
  }
  for (i = 1; i <= n; ++i) {
    y = top + row * (i - 0.5)
    printf "<text x=\"12\" y=\"%.1f\">%s</text>\n", y + 4, engine[i]
    if (verdict[i] != "ok" && verdict[i] != "open" && error[i] == "-") {
      printf "<text x=\"%d\" y=\"%.1f\" fill=\"#555\">%s</text>\n", left + 4, y + 4, verdict[i]
      continue
    }
    if (error[i] != "-") printf "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"4\" fill=\"#0072b2\"/>\n", at(error[i]), y
    if (explained[i] != "-") printf "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"7\" fill=\"none\" stroke=\"#e69f00\" stroke-width=\"2\"/>\n", at(explained[i]), y
    if (unexplained[i] != "-") printf "<path d=\"M%.1f %.1f l5 -5 l5 5 l-5 5 z\" fill=\"#d55e00\"/>\n", at(unexplained[i]) - 5, y
  }
  y = bottom + 34
  printf "<circle cx=\"160\" cy=\"%d\" r=\"4\" fill=\"#0072b2\"/><text x=\"170\" y=\"%d\">error, relative to the scale</text>\n", y - 4, y
  printf "<circle cx=\"350\" cy=\"%d\" r=\"7\" fill=\"none\" stroke=\"#e69f00\" stroke-width=\"2\"/><text x=\"362\" y=\"%d\">explained by the scheme</text>\n", y - 4, y
  printf "<path d=\"M525 %d l5 -5 l5 5 l-5 5 z\" fill=\"#d55e00\"/><text x=\"540\" y=\"%d\">unexplained</text>\n", y - 4, y
  print "</svg>"
}
