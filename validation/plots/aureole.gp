# X.iprt: the sky at the sun's height under the cloud of case A5 (aureole.csv).
width = 620; height = 380
load style
set xrange [0:180]; set xtics 30
set xlabel 'azimuth from the sun [deg]'
set logscale y; set yrange [0.04:20]
set ylabel 'radiance / irradiance [1/sr]'
set datafile missing ''
set key top right
plot 'aureole.csv' using 'azimuth_deg':'I' with lines title '64 terms', \
     '' using 'azimuth_deg':'I_40' with lines dashtype 2 title '40 terms', \
     '' using 'azimuth_deg':'I_mystic' with points title 'MYSTIC'
