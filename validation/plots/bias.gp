# X.error: bias of three estimates of the DoLP against the true one, in units of its error (bias.csv).
width = 640; height = 420
load style
set xlabel 'true DoLP / error b'
set ylabel 'bias / b'
set xrange [0:6]
set key top right samplen 3
plot 0 with lines linestyle 12, 'bias.csv' using 'ratio':'length' with lines linetype 1 title 'the length itself', \
     '' using 'ratio':'wardle_kronberg' with lines linetype 2 title 'Wardle and Kronberg', \
     '' using 'ratio':'modified' with lines linetype 3 title 'modified asymptotic'
