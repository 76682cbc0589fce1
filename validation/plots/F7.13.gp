# F7.13: mean S0 of the tops against the number of rays, and the sun sampled twice (convergence.csv).
width = 860
height = 380
load style
set multiplot layout 1,2
set logscale x
set xtics (2, 5, 10, 20, 45, 100) format '%g'
set xrange [2:125]
set xlabel 'rays from the first intersection'
set ylabel 'mean S_0 / converged'
set key top right samplen 2
set title 'convergence' font ',12'
set yrange [0.97:1.12]
plot 1 with lines linestyle 12, \
     'convergence.csv' using 'rays':'bright' with linespoints linetype 1 title 'Lambertian, bright', \
     'convergence.csv' using 'rays':'dark' with linespoints linetype 2 title 'Lambertian, dark', \
     'convergence.csv' using 'rays':'copper' with linespoints linetype 3 title 'copper'
set title 'sun in a ring of 45 rays' font ',12'
set key top left
set yrange [0.9:400]
set logscale y
plot 1 with lines linestyle 12, \
     'convergence.csv' using 'rays':'sun_twice' with linespoints linetype 2 title 'sun sampled twice', \
     'convergence.csv' using 'rays':'sun_once' with linespoints linetype 1 title 'sun sampled once'
unset multiplot
