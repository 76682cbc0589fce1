# Panels of simulated images with one stretch and one colour bar (images.csv, images-panels.csv).
#
# <pictures>-panels.csv: title,low,high,map,across,unit: a row for each panel, in reading order. map is grey,
# level, signed or hue; across is the number of panels in a row; unit is the legend of the colour bar. Where not all
# panels have one stretch and one map, each has its own colour bar; if only the last
# differs, it has one below itself, and the others share theirs.
# <pictures>.csv: x, y and a column for each panel; x counts pixels from the left, y rows from the top. Columns are
# asked for by number: for a name, gnuplot evaluates an expression at every pixel, which takes twice as long.
if (!exists("pictures")) pictures = 'images'
panels_file = pictures . '-panels.csv'
set datafile separator ','
set datafile columnheaders
panels = 0
array Title[64]; array Low[64]; array High[64]; array Map[64]
across = 1
unit = ''
stats panels_file using (panels = panels + 1, Title[panels] = strcol('title'), \
  Low[panels] = column('low'), High[panels] = column('high'), \
  Map[panels] = strcol('map'), across = column('across'), unit = strcol('unit'), 0) nooutput
differs(i) = Low[i] != Low[1] || High[i] != High[1] || Map[i] ne Map[1]
one_bar = 1
do for [i = 2:panels - 1] {
  if (differs(i)) { one_bar = 0 }
}
last_apart = one_bar && panels > 2 && differs(panels)
if (!last_apart && differs(panels)) { one_bar = 0 }
down = ceil(panels / real(across))
panel = 190
gap = one_bar ? 8 : 70
bar = one_bar ? 130 : 10
foot = last_apart ? 30 : 0
width = across * (panel + gap) + bar
height = down * (panel + 26) + 8 + foot
load style

set border 15 linecolor rgb '#b8b8b8' linewidth 0.5
unset grid
unset key
unset xtics
unset ytics
set size ratio -1
set yrange [*:*] reverse
set multiplot
do for [i = 1:panels] {
  right = (i - 1) % int(across)
  row = (i - 1) / int(across)
  set lmargin at screen (right * (panel + gap) + 4.0) / width
  set rmargin at screen (right * (panel + gap) + 4.0 + panel) / width
  set tmargin at screen 1 - (row * (panel + 26) + 24.0) / height
  set bmargin at screen 1 - (row * (panel + 26) + 24.0 + panel) / height
  set title Title[i] font (strlen(Title[i]) > 24 ? ',10' : ',12') offset 0,-0.8
  set cbrange [Low[i]:High[i]]
  if (Map[i] eq 'signed') { @signed_map }
  if (Map[i] eq 'level') { @level_map }
  if (Map[i] eq 'grey') { @grey_map }
  if (Map[i] eq 'hue') { @hue_map }
  set cbtics font ',12' scale 0.5 offset -0.8,0
  if (one_bar) {
    unset colorbox
    if (i == panels - last_apart) {
      set colorbox user origin screen (across * (panel + gap) + 8.0) / width, (12.0 + foot) / height \
        size screen 12.0 / width, (height - foot - 36.0) / height
      set cblabel unit font ',12' offset 0,0
    }
    if (i == panels && last_apart) {
      set colorbox horizontal user origin screen (right * (panel + gap) + 4.0) / width, 20.0 / height \
        size screen real(panel) / width, 9.0 / height
      set cbtics High[i] / 2.0 offset 0,0.6 format '%.2g'
      unset cblabel
    }
  } else {
    set colorbox user origin screen (right * (panel + gap) + panel + 8.0) / width, \
      1 - (row * (panel + 26) + 24.0 + panel) / height size screen 8.0 / width, real(panel) / height
    set cblabel ''
  }
  number = i + 2
  plot pictures . '.csv' using 1:2:number with image
}
unset multiplot
