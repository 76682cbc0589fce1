# X.iprt: the sky at the sun's height under the cloud of case A5, and what fewer terms and streams make of it (aureole.csv).
width = 900; height = 400
load style
set xrange [0:180]; set xtics 45
set xlabel 'azimuth from the sun [deg]'
set datafile missing ''
set multiplot
set lmargin at screen 0.13; set rmargin at screen 0.47
set tmargin at screen 0.95; set bmargin at screen 0.20
set logscale y; set yrange [0.04:20]
set ylabel 'radiance / irradiance [1/sr]'
set key top right
plot 'aureole.csv' using 'azimuth_deg':'I' with lines title 'ours', \
     '' using 'azimuth_deg':'I_mystic' with points title 'MYSTIC'
set lmargin at screen 0.60; set rmargin at screen 0.97
unset logscale y; set yrange [-8:12]; set xrange [0:60]; set xtics 15
set ylabel 'off by [%]'
plot 'aureole.csv' using 'azimuth_deg':'usual' with lines title '64 terms, 64 streams', \
     '' using 'azimuth_deg':'streams' with lines title '64 terms, 32 streams', \
     '' using 'azimuth_deg':'terms' with lines title '24 terms', \
     '' using 'azimuth_deg':'bare' with lines title '24, no aureole'
unset multiplot
