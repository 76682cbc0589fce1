# Finding 3: five hypotheses on the diffuse term, what table 7.1 demands of it, and the DoLP of aluminium under each.
width = 860; height = 520
load style
set multiplot
set xrange [0:90]; set xtics 15; set xlabel 'view zenith [deg]'
set lmargin 11; set rmargin 3
set origin 0,0.2; set size 0.5,0.8
set ylabel '(1 - DHR) / π [sr^{-1}]'
set yrange [-0.01:0.04]
unset key
plot 'hypotheses.csv' using 'view_deg':'none' with lines linetype 7, \
     '' using 'view_deg':'incidence' with lines linetype 2, \
     '' using 'view_deg':'vgroove' with lines linetype 1 linewidth 3, \
     '' using 'view_deg':'unshadowed' with lines linetype 4, \
     '' using 'view_deg':'smith' with lines linetype 3, \
     'witness.csv' using 'view_deg':'low_per_sr':(column('view_deg')-2):(column('view_deg')+2):'low_per_sr':'high_per_sr' \
        with boxxyerror linetype 7 dashtype solid linewidth 2 fillstyle solid 0.25 border
set origin 0.5,0.2; set size 0.5,0.8
set ylabel 'DoLP at 5 deg incidence'
set yrange [0:0.04]
set object 1 rectangle from 60, graph 0 to 70, graph 1 fillcolor rgb '#eeeeee' fillstyle solid noborder behind
plot 'hypotheses.csv' using 'view_deg':'dolp_none' with lines linetype 7, \
     '' using 'view_deg':'dolp_incidence' with lines linetype 2, \
     '' using 'view_deg':'dolp_vgroove' with lines linetype 1 linewidth 3, \
     '' using 'view_deg':'dolp_unshadowed' with lines linetype 4, \
     '' using 'view_deg':'dolp_smith' with lines linetype 3
# the key of both, in a strip of its own
unset object 1
set origin 0,0.01; set size 1,0.18
set lmargin 2; set rmargin 2; set bmargin 0; set tmargin 0
unset border; unset xtics; unset ytics; unset grid; unset xlabel; unset ylabel
set yrange [0:1]
set key center center horizontal maxrows 2 Left reverse samplen 3 width 1
plot NaN with lines linetype 7 title 'no diffuse term', NaN with lines linetype 2 title 'V-groove at the source', \
     NaN with lines linetype 1 linewidth 3 title 'V-groove at the viewer', \
     NaN with lines linetype 4 title 'unshadowed at the viewer', NaN with lines linetype 3 title 'Smith at the viewer', \
     NaN with boxes linetype 7 dashtype solid linewidth 2 fillstyle solid 0.25 border title 'table 7.1 demands'
unset multiplot
