# Table 7.1, manual column: ours minus printed in half units of the last printed digit.
width = 760; height = 380
load style
set ylabel "ours minus printed,\nhalf units of the last digit"
set xtics rotate by -60 left scale 0.3
set yrange [-6:12]
set xrange [0:*]
set key top right opaque
set rmargin 6
plot 1 with lines linestyle 12, -1 with lines linestyle 12, \
     'residuals.csv' using 'number':'full_residual':xticlabels(stringcolumn('label')) with points linetype 2 pointsize 0.9 title 'full matrix', \
     '' using 'number':'by_hand_residual' with points linetype 1 pointsize 0.9 title 'matrix rounded as in eq 7.8'
