# Figure 3.9: reflectances and degree of polarisation for n = 2 (fresnel.csv).
load style
set xrange [0:90]
set yrange [0:1.02]
set xtics 15
set format x '%g°'
set xlabel 'incident zenith angle'
set ylabel 'reflectance, degree of polarisation'
set key top left at graph 0.06, graph 0.97
brewster = atan(2) * 180 / pi
set arrow 1 from brewster, 0 to brewster, 1 nohead linestyle 12
set label 1 sprintf("Brewster\n%.2f°", brewster) at brewster - 1, 0.50 right textcolor rgb '#808080'
plot 'fresnel.csv' using 'theta_i_deg':'Rs' with lines linetype 1 title 'R_{⊥} (s)', \
     'fresnel.csv' using 'theta_i_deg':'Rp' with lines linetype 2 title 'R_{||} (p)', \
     'fresnel.csv' using 'theta_i_deg':'DoP' with lines linetype 3 linewidth 2.5 dashtype solid title 'DoP'
