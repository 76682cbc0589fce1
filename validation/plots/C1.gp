# Error of the unpolarised prediction against the orientation of linearly polarised light.
load style
set xlabel 'angle of linear polarisation, from the perpendicular s [deg]'
set ylabel "polarised minus\nunpolarised [%]"
set xrange [0:180]; set xtics 30
set key top center
plot 0 with lines linestyle 12, \
     'orientation.csv' using 'AoLP_deg':'error_DoLP1' with lines linetype 1 title 'DoLP 1', \
     '' using 'AoLP_deg':'error_DoLP05' with lines linetype 2 title 'DoLP 0.5'
