# X.basis: error of a sum of basis functions, and matrices that do not exist, against the number of coefficients.
width = 860; height = 420
load style
of(s, c) = stringcolumn('surface') eq s ? column(c) : NaN
set multiplot
set lmargin 11; set rmargin 3
set logscale x; set xlabel 'coefficients'; set xrange [10:4000]
set datafile missing NaN
set origin 0,0; set size 0.5,1
set logscale y; set ylabel 'error [%]'; set yrange [0.1:100]
set key at graph 0.02,0.34 left top Left reverse samplen 2
plot for [s in 'copper water coating smooth'] 'basis.csv' using 'coefficients':(of(s, 'error_percent')) with linespoints title (s eq 'smooth' ? 'copper (Smith)' : s)
set origin 0.5,0; set size 0.5,1
unset logscale y; set ylabel 'matrices that do not exist [%]'; set yrange [0:60]; unset key
plot for [s in 'copper water coating smooth'] 'basis.csv' using 'coefficients':(of(s, 'unrealizable_percent')) with linespoints title (s eq 'smooth' ? 'copper (Smith)' : s)
unset multiplot
