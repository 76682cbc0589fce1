# X.sky: the polarisation around the sun (around.csv), and the neutral points (around-marks.csv).
width = 860; height = 360
load style
set size ratio -1
set xrange [-30:30]; set yrange [-30:30]
set xtics -20,10,20; set ytics -20,10,20
set tmargin at screen 0.88; set bmargin at screen 0.19
set xlabel 'right of the sun [deg]' offset 0,0.4
array Columns[3]; Columns[1] = 'once'; Columns[2] = 'more'; Columns[3] = 'all'
array Title[3]; Title[1] = 'scattered once'; Title[2] = '+ scattered more often'; Title[3] = '= the sky'
longest = 5.5  # degrees of the picture for half a bar of light that is fully polarised
across(name) = longest * column(name . '_x')
along(name) = longest * column(name . '_y')
set style textbox opaque noborder fillcolor rgb '#ffffff' margins 0.3,0.3
set multiplot
do for [i = 1:3] {
  set lmargin at screen (i - 1) * 0.308 + 0.085
  set rmargin at screen (i - 1) * 0.308 + 0.365
  set title Title[i] offset 0,-0.5
  if (i == 1) { set ylabel 'above the sun [deg]' offset 1.2,0; set ytics format '%g' }
  if (i > 1) { unset ylabel; set ytics format '' }
  plot 'around.csv' using (column('x_deg') - across(Columns[i])):(column('y_deg') - along(Columns[i])): \
         (2 * across(Columns[i])):(2 * along(Columns[i])) with vectors nohead linetype 1 linewidth 1.6, \
       'around-marks.csv' using 'x':'y' every ::::(i == 3 ? 2 : 0) with points pointtype 6 pointsize 1.1 linewidth 1.8 linecolor rgb '#d55e00', \
       'around-marks.csv' using (column('x') + 1.5):(column('y') + 1.6):(strcol('name')) every ::::(i == 3 ? 2 : 0) \
         with labels left boxed font ',11' textcolor rgb '#d55e00'
}
unset multiplot
