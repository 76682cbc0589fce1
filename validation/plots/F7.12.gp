# F7.12: the chunky bar from above, each facet in its own colour (facets.csv) and with its name (labels.csv).
width = 520
height = 520
load style
unset border
unset grid
unset xtics
unset ytics
unset colorbox
set size ratio -1
unset key
set lmargin 1
set rmargin 1
set tmargin 1
set bmargin 1
set yrange [*:*] reverse
# six numbers a chunk, from dark (the top is the first) to light; 0 is the ground
set palette maxcolors 240 defined (-0.5 '#f2f2f2', 0.5 '#f2f2f2', 0.5 '#56a8dc', 5.9 '#cfe8f7', 6.5 '#e08a4a', 11.9 '#fbe3cf', 12.5 '#4ab594', 17.9 '#cdeee2', 18.5 '#cc8ab4', 23.9 '#f6e2ee')
set cbrange [-0.5:23.9]
plot 'facets.csv' using 'x':'y':'facet' with image, \
     'labels.csv' using 'x':'y':'name' with labels font ',9' textcolor rgb '#000000'
