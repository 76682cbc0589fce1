# Finding 3: readings of the diffuse term against the printed digits of the plate, and the figures 7.7 and 7.10.
width = 1180; height = 520
load style
set multiplot
set lmargin 9; set rmargin 2
unset key
set origin 0,0.2; set size 0.34,0.8
set xrange [0:0.045]; set xtics 0.01; set xlabel '1 - DHR at the plate'
set logscale y; set yrange [0.5:20]; set ytics (0.5, 1, 2, 5, 10, 20); set ylabel 'worst digit [half units]'
plot 'profile.csv' using 'remainder':'worst_half_units' with lines linetype 8 linewidth 2, \
     1 with lines linetype 7 dashtype 2, \
     'trials.csv' using 'remainder':'worst_half_units' with points pointtype 6 pointsize 1.1 linetype 7, \
     '' every ::0::0 using 'remainder':'worst_half_units' with points pointtype 7 pointsize 1.4 linetype 7, \
     '' every ::2::2 using 'remainder':'worst_half_units' with points pointtype 7 pointsize 1.4 linetype 2, \
     '' every ::3::3 using 'remainder':'worst_half_units' with points pointtype 7 pointsize 1.4 linetype 1, \
     '' every ::5::5 using 'remainder':'worst_half_units' with points pointtype 7 pointsize 1.4 linetype 5, \
     '' every ::8::8 using 'remainder':'worst_half_units' with points pointtype 7 pointsize 1.4 linetype 4, \
     '' every ::11::11 using 'remainder':'worst_half_units' with points pointtype 7 pointsize 1.4 linetype 3
unset logscale y; set ytics autofreq
set xrange [0:90]; set xtics 15; set xlabel 'view zenith [deg]'
set origin 0.34,0.2; set size 0.33,0.8
set ylabel 'diffuse term [sr^{-1}]'
set yrange [-0.01:0.04]
plot 'hypotheses.csv' using 'view_deg':'none' with lines linetype 7, \
     '' using 'view_deg':'source' with lines linetype 2, \
     '' using 'view_deg':'vgroove' with lines linetype 1 linewidth 3, \
     '' using 'view_deg':'product' with lines linetype 5, \
     '' using 'view_deg':'unshadowed' with lines linetype 4, \
     '' using 'view_deg':'smith' with lines linetype 3, \
     'witness.csv' using 'view_deg':'low_per_sr':(column('view_deg')-2):(column('view_deg')+2):'low_per_sr':'high_per_sr' \
        with boxxyerror linetype 7 dashtype solid linewidth 2 fillstyle solid 0.25 border
set origin 0.67,0.2; set size 0.33,0.8
set ylabel 'DoLP at 5 deg incidence'
set yrange [0:0.04]
set object 1 rectangle from 60, graph 0 to 70, graph 1 fillcolor rgb '#eeeeee' fillstyle solid noborder behind
plot 'hypotheses.csv' using 'view_deg':'dolp_none' with lines linetype 7, \
     '' using 'view_deg':'dolp_source' with lines linetype 2, \
     '' using 'view_deg':'dolp_vgroove' with lines linetype 1 linewidth 3, \
     '' using 'view_deg':'dolp_product' with lines linetype 5, \
     '' using 'view_deg':'dolp_unshadowed' with lines linetype 4, \
     '' using 'view_deg':'dolp_smith' with lines linetype 3
# the key of all, in a separate strip
unset object 1
set origin 0,0.01; set size 1,0.18
set lmargin 2; set rmargin 2; set bmargin 0; set tmargin 0
unset border; unset xtics; unset ytics; unset grid; unset xlabel; unset ylabel
set yrange [0:1]
set key center center horizontal maxrows 2 Left reverse samplen 3 width 1
plot NaN with lines linetype 7 title 'no diffuse term', NaN with lines linetype 2 title 'V-groove at the source', \
     NaN with lines linetype 1 linewidth 3 title 'V-groove at the viewer', NaN with lines linetype 5 title 'V-groove, product', \
     NaN with lines linetype 4 title 'unshadowed at the viewer', NaN with lines linetype 3 title 'Smith at the viewer', \
     NaN with lines linetype 8 linewidth 2 title 'any size', \
     NaN with boxes linetype 7 dashtype solid linewidth 2 fillstyle solid 0.25 border title 'the digits demand'
unset multiplot
