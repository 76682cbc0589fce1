# X.glint: polarisation at the mirror point, and the roughness read from the glint, against the wind (wind.csv).
width = 900; height = 400
load style
set xrange [0:15]; set xtics 5
set xlabel 'wind [m/s]'
set multiplot
set lmargin at screen 0.11; set rmargin at screen 0.46
set tmargin at screen 0.95; set bmargin at screen 0.18
set ylabel 'DoLP'; set yrange [0.8:1]; set ytics 0.05
set key bottom left
plot 'wind.csv' using 'wind_m_s':'dolp_sea' with lines title 'surface', \
     '' using 'wind_m_s':'dolp_plane_clear' with lines title '3 km, clear', \
     '' using 'wind_m_s':'dolp_space_clear' with lines title 'space, clear', \
     '' using 'wind_m_s':'dolp_plane_haze' with lines title '3 km, haze', \
     '' using 'wind_m_s':'dolp_space_haze' with lines title 'space, haze'
set lmargin at screen 0.60; set rmargin at screen 0.97
set ylabel 'mean square slope'; set yrange [0:*]; set ytics 0.02
set key top left
plot 'wind.csv' using (column('wind_m_s')):(column('truth') - 0.004):(column('truth') + 0.004) with filledcurves linecolor rgb '#dddddd' title 'Cox and Munk', \
     '' using 'wind_m_s':'clear' with points linetype 1 title '610 m, clear', \
     '' using 'wind_m_s':'plane' with points linetype 4 title '610 m, haze', \
     '' using 'wind_m_s':'space' with points linetype 2 title 'space, haze', \
     '' using 'wind_m_s':'corrected' with points linetype 3 title 'space, corrected'
unset multiplot
