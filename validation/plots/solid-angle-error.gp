# Claim C6: error of the light on a uniformly lit Lambertian surface against the number of directions
# (errors.csv).
load style
set logscale xy
set xrange [6:5500]
set yrange [0.0015:1]
set xlabel 'number of random directions'
set ylabel 'relative error (rms)'
set format y '%g'
set key at graph 0.02, graph 0.34 left top Left reverse
floor = 4 / pi - 1
set arrow 1 from 6, floor to 5500, floor nohead linestyle 12
set label 1 '4/π − 1' at 5200, floor * 0.72 right textcolor rgb '#808080'
plot 'errors.csv' using 'samples':'rms_equal' with linespoints linetype 2 dashtype solid title 'equal weights, uniform in angle', \
     'errors.csv' using 'samples':'rms_exact' with linespoints linetype 1 dashtype solid title 'exact weights, uniform in angle', \
     'errors.csv' using 'samples':'rms_uniform' with linespoints linetype 3 dashtype solid title 'equal weights, uniform in solid angle', \
     'errors.csv' using 'samples':'expected' with lines linestyle 12 title '1/√(3N)'
