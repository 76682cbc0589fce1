# X.paint: the face of a paint, n = 1.5: what passes from outside (face.csv) and what returns inside (face-inside.csv).
width = 900; height = 400
load style
set multiplot
set xrange [0:90]; set xtics 30
set tmargin at screen 0.88; set bmargin at screen 0.21
set lmargin at screen 0.08; set rmargin at screen 0.48
set title 'passed, light from outside'
set xlabel 'angle in air [deg]'
set yrange [-0.3:1]; set ytics 0.2
set key at 4,0.55 left Left reverse
set label 1 'T_0' at 20,0.9 textcolor rgb ink
set label 2 'T_1' at 20,0.06 textcolor rgb ink
set arrow 1 from 0,0 to 90,0 nohead linestyle 12
plot 'face.csv' using 'zenith_deg':'smooth_T0' with lines linetype 1 title 'smooth', \
     '' using 'zenith_deg':'rough_T0' with lines linetype 2 title 'σ = 0.3', \
     '' using 'zenith_deg':'film_T0' with lines linetype 3 title 'quarter-wave film', \
     '' using 'zenith_deg':'smooth_T1' with lines linetype 1, \
     '' using 'zenith_deg':'rough_T1' with lines linetype 2
unset label 1; unset label 2; unset arrow 1
set lmargin at screen 0.57; set rmargin at screen 0.97
set title 'returned, light from the binder'
set xlabel 'angle in the binder [deg]'
set yrange [0:1.05]
set key at 50,0.5 left Left reverse
plot 'face-inside.csv' using 'inside_deg':'smooth' with lines linetype 1 title 'smooth', \
     '' using 'inside_deg':'rough' with lines linetype 2 title 'σ = 0.3'
unset multiplot
