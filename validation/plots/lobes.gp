# Figure 5.1: the lobe of the older DIRSIG in three forms over a diffuse part (lobes.csv).
width = 700; height = 400
load style
set xrange [-85:85]; set xtics 20
set yrange [0:1.25]
set xlabel 'view zenith [deg], source at -40'
set ylabel 'f_{00} [sr^{-1}]'
set key top left Left reverse
set arrow 1 from 40, graph 0 to 40, 1.095 nohead linestyle 12
set arrow 2 from 30, 0.595 to 50, 0.595 heads filled size 2,20 linecolor rgb ink linewidth 1
set label 2 'width' at 52, 0.60 left textcolor rgb ink
set arrow 3 from -15, 0.0955 to -15, 1.095 heads filled size 2,20 linecolor rgb ink linewidth 1
set arrow 4 from -18, 1.095 to 40, 1.095 nohead linestyle 12
set label 3 'height' at -13, 0.55 left textcolor rgb ink
plot for [c in 'cone cosine exponential'] 'lobes.csv' using 'view_deg':c with lines title c, \
     'lobes.csv' using 'view_deg':'diffuse' with lines linestyle 12 linewidth 2 title 'diffuse'
