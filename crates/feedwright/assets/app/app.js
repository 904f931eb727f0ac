var e=document.createElement(`span`);e.hidden=!0,document.body.append(e);function t(t){return e.style.color=`var(${t})`,getComputedStyle(e).color}var n=()=>matchMedia(`(prefers-color-scheme: dark)`).matches,r=[[104,148,205],[127,143,208],[138,104,186],[141,63,159],[124,18,119],[62,0,66]],i=[[74,110,184],[44,128,160],[38,158,140],[74,190,110],[160,218,57],[253,231,37]];function a(e){let t=n()?i:r,a=Math.min(1,Math.max(0,e))*(t.length-1),o=Math.min(t.length-2,Math.floor(a)),s=a-o;return`rgb(${t[o].map((e,n)=>Math.round(e+s*(t[o+1][n]-e))).join(`,`)})`}var o=e=>document.getElementById(e);function s(e,t=``,n=``){let r=document.createElement(e);return[r.textContent,r.className]=[t,n],r}function c(e,t){document.querySelectorAll(e).forEach(e=>e.setAttribute(`aria-pressed`,String(t(e))))}function l(e,t,n){e.append(...t.map(({name:e,about:t})=>{let r=new Option(e,e,e===n,e===n);return r.title=t,r}))}function u(e,t){let n=s(`a`);n.href=URL.createObjectURL(t),n.download=e,n.click(),setTimeout(()=>URL.revokeObjectURL(n.href),6e4)}var d={star:{about:`Rounded star, 220 arcs`,program:`(Rounded five-pointed star: 12 + 4 cos 5a times cos a, sin a, a from 0 to 360 degrees, mm)
(220 arcs, tangent to each other, within 0.5 um of the curve; 50 mm/s)
G21 G17 G90 G94 G64
G0 X16 Y0
F3000
G3 X15.947847 Y0.477472 I-2.211748 J0
G3 X15.799018 Y0.934757 I-2.422766 J-0.535657
G3 X15.550912 Y1.384271 I-2.543585 J-1.110687
G3 X15.232065 Y1.787838 I-2.969022 J-2.017998
G3 X14.833549 Y2.169336 I-3.048018 J-2.785089
G3 X14.392518 Y2.501626 I-3.473735 J-4.151681
G3 X13.820786 Y2.844958 I-3.469101 J-5.1292
G3 X13.218642 Y3.13255 I-3.777312 J-7.134564
G3 X12.440379 Y3.424554 I-3.610597 J-8.439998
G3 X11.640928 Y3.653518 I-3.695671 J-11.393646
G3 X10.714686 Y3.850517 I-3.304596 J-13.261432
G3 X9.77822 Y3.993108 I-3.462232 J-19.591789
G3 X9.137468 Y4.066925 I-3.249803 J-25.391443
G3 X8.495646 Y4.13127 I-15.083808 J-147.2233
G2 X8.077795 Y4.173563 I6.542457 J66.723726
G2 X7.661 Y4.2247 I1.205864 J11.552475
G2 X7.385684 Y4.268932 I1.017841 J7.214414
G2 X7.113796 Y4.329943 I0.584684 J3.241906
G2 X6.91978 Y4.391347 I0.608885 J2.261102
G2 X6.735242 Y4.476026 I0.434334 J1.189941
G2 X6.591191 Y4.575089 I0.464961 J0.830387
G2 X6.472136 Y4.702282 I0.450546 J0.541032
G2 X6.383344 Y4.866462 I0.571289 J0.415066
G2 X6.333624 Y5.047208 I0.925814 J0.351886
G2 X6.313711 Y5.251959 I1.321867 J0.231898
G2 X6.318034 Y5.458063 I2.50212 J0.050624
G2 X6.347294 Y5.742209 I3.525152 J-0.21943
G2 X6.393123 Y6.024348 I7.875195 J-1.134406
G2 X6.477139 Y6.448159 I12.720992 J-2.301574
G2 X6.569149 Y6.870367 I98.008034 J-21.137146
G3 X6.70951 Y7.518672 I-92.288214 J20.320212
G3 X6.838635 Y8.169247 I-23.552735 J5.012813
G3 X6.989613 Y9.124201 I-18.750221 J3.453822
G3 X7.081214 Y10.086331 I-13.119509 J1.734489
G3 X7.100146 Y10.902943 I-11.579635 J0.676978
G3 X7.0529 Y11.718054 I-8.904405 J-0.107199
G3 X6.957649 Y12.367278 I-7.786995 J-0.810872
G3 X6.800336 Y13.0039 I-5.896538 J-1.119319
G3 X6.613804 Y13.516583 I-5.015099 J-1.534391
G3 X6.367381 Y14.002728 I-3.683619 J-1.561673
G3 X6.069042 Y14.427716 I-2.98658 J-1.779349
G3 X5.703374 Y14.795018 I-2.082884 J-1.707948
G3 X5.343606 Y15.041941 I-1.551496 J-1.874978
G3 X4.944272 Y15.216904 I-1.082356 J-1.927163
G3 X4.474053 Y15.314851 I-0.683468 J-2.103497
G3 X3.993158 Y15.314615 I-0.239236 J-2.469715
G3 X3.488976 Y15.217559 I0.270316 J-2.762314
G3 X3.006632 Y15.039027 I1.001752 J-3.447303
G3 X2.520657 Y14.777905 I1.706888 J-3.759477
G3 X2.068345 Y14.461143 I2.875041 J-4.586658
G3 X1.565142 Y14.023489 I3.806148 J-4.884321
G3 X1.105553 Y13.539687 I5.61812 J-5.797139
G3 X0.587344 Y12.889749 I6.911179 J-6.041984
G3 X0.122543 Y12.20018 I9.693976 J-7.035623
G3 X-0.351039 Y11.380148 I11.591195 J-7.240866
G3 X-0.776035 Y10.533578 I17.56301 J-9.346975
G3 X-1.044242 Y9.946997 I23.144453 J-10.937134
G3 X-1.303772 Y9.356472 I135.356525 J-59.840055
G2 X-1.473119 Y8.972141 I-61.436304 J26.841011
G2 X-1.65055 Y8.591549 I-10.614423 J4.716756
G2 X-1.777694 Y8.343375 I-6.546784 J3.1974
G2 X-1.919736 Y8.103648 I-2.902558 J1.557872
G2 X-2.038089 Y7.938102 I-1.962281 J1.277803
G2 X-2.17565 Y7.788764 I-0.997485 J0.780789
G2 X-2.314378 Y7.682375 I-0.646063 J0.698807
G2 X-2.472136 Y7.608452 I-0.375326 J0.595683
G2 X-2.655719 Y7.57474 I-0.218213 J0.67159
G2 X-2.842982 Y7.583307 I-0.048571 J0.989241
G2 X-3.043866 Y7.627641 I0.18793 J1.328831
G2 X-3.238546 Y7.695441 I0.725052 J2.3953
G2 X-3.499744 Y7.811076 I1.298022 J3.284812
G2 X-3.753912 Y7.941848 I3.512454 J7.139204
G2 X-4.131018 Y8.152716 I6.119929 J11.387156
G2 X-4.504129 Y8.370692 I50.388769 J86.679442
G3 X-5.077329 Y8.70452 I-47.844296 J-81.492016
G3 X-5.656161 Y9.028364 I-12.045664 J-20.850937
G3 X-6.517721 Y9.46705 I-9.078917 J-16.765229
G3 X-7.404456 Y9.851483 I-5.703749 J-11.941407
G3 X-8.17525 Y10.121835 I-4.222148 J-10.80369
G3 X-8.965066 Y10.328784 I-2.649659 J-8.501719
G3 X-9.611949 Y10.438816 I-1.635128 J-7.656445
G3 X-10.266024 Y10.48593 I-0.757595 J-5.953829
G3 X-10.811257 Y10.466956 I-0.090459 J-5.243796
G3 X-11.349757 Y10.38282 I0.346938 J-3.985914
G3 X-11.846137 Y10.230411 I0.769358 J-3.390255
G3 X-12.308459 Y9.996143 I0.98071 J-2.508725
G3 X-12.654471 Y9.730287 I1.303772 J-2.05496
G3 X-12.944272 Y9.404564 I1.498374 J-1.624908
G3 X-13.18273 Y8.987626 I1.789342 J-1.300033
G3 X-13.33111 Y8.530196 I2.27491 J-0.99071
G3 X-13.394606 Y8.020698 I2.710648 J-0.596517
G3 X-13.373864 Y7.506792 I3.588138 J-0.112553
G3 X-13.275697 Y6.963911 I4.102932 J0.461604
G3 X-13.11421 Y6.435851 I5.250608 J1.316971
G3 X-12.853475 Y5.822035 I5.821429 J2.110525
G3 X-12.535373 Y5.235437 I7.249501 J3.551735
G3 X-12.07738 Y4.541749 I7.881941 J4.705846
G3 X-11.565193 Y3.886608 I9.686878 J7.045392
G3 X-10.931641 Y3.182801 I10.468349 J8.786331
G3 X-10.257836 Y2.517001 I14.31677 J13.815041
G3 X-9.782845 Y2.080658 I17.553861 J18.631923
G3 X-9.301421 Y1.651348 I98.738741 J110.240111
G2 X-8.988232 Y1.371525 I-44.512181 J-50.135069
G2 X-8.681096 Y1.085169 I-7.765939 J-8.637359
G2 X-8.484359 Y0.887557 I-5.063977 J-5.238312
G2 X-8.300259 Y0.678387 I-2.378564 J-2.279088
G2 X-8.179388 Y0.51467 I-1.82164 J-1.471377
G2 X-8.079867 Y0.337695 I-1.050814 J-0.707387
G2 X-8.021555 Y0.17288 I-0.86425 J-0.3985
G2 X-8 Y0 I-0.682511 J-0.17288
G2 X-8.024668 Y-0.185015 I-0.706152 J0
G2 X-8.090684 Y-0.360466 I-0.955833 J0.259498
G2 X-8.194924 Y-0.537818 I-1.205719 J0.589364
G2 X-8.319566 Y-0.702019 I-2.054013 J1.429754
G2 X-8.510255 Y-0.914699 I-2.72293 J2.249556
G2 X-8.713169 Y-1.116017 I-5.704379 J5.546677
G2 X-9.030249 Y-1.409503 I-8.938666 J9.339224
G2 X-9.352853 Y-1.696995 I-66.866061 J74.707987
G3 X-9.847472 Y-2.138982 I62.718812 J-70.685047
G3 X-10.334335 Y-2.589411 I16.108105 J-17.899401
G3 X-11.017787 Y-3.273242 I13.139142 J-13.815304
G3 X-11.65742 Y-3.99778 I9.594399 J-9.114685
G3 X-12.152728 Y-4.647305 I8.970205 J-7.354026
G3 X-12.593615 Y-5.334515 I7.266825 J-5.147152
G3 X-12.89816 Y-5.915735 I6.776429 J-3.921071
G3 X-13.145088 Y-6.523239 I5.428318 J-2.56035
G3 X-13.295528 Y-7.047649 I4.959193 J-1.706453
G3 X-13.381916 Y-7.585793 I3.898039 J-0.901757
G3 X-13.390357 Y-8.104974 I3.462069 J-0.315943
G3 X-13.31042 Y-8.617062 I2.688995 J0.157471
G3 X-13.164499 Y-9.028293 I2.357271 J0.604943
G3 X-12.944272 Y-9.404564 I2.008402 J0.922914
G3 X-12.621428 Y-9.760192 I1.789342 J1.300033
G3 X-12.232238 Y-10.042664 I1.645207 J1.857422
G3 X-11.767298 Y-10.260495 I1.404958 J2.393646
G3 X-11.272135 Y-10.399574 I1.21584 J3.377741
G3 X-10.725489 Y-10.473971 I0.828864 J4.044764
G3 X-10.173372 Y-10.483568 I0.370014 J5.400591
G3 X-9.509026 Y-10.425274 I-0.208308 J6.188697
G3 X-8.85284 Y-10.304009 I-1.137682 J7.992232
G3 X-8.051576 Y-10.082794 I-2.039871 J8.950357
G3 X-7.270225 Y-9.798124 I-3.707156 J11.389915
G3 X-6.405086 Y-9.413068 I-5.121399 J12.671117
G3 X-5.563656 Y-8.977986 I-8.71476 J17.885139
G3 X-5.001889 Y-8.66108 I-12.29557 J22.452295
G3 X-4.444822 Y-8.335883 I-74.332627 J127.972191
G2 X-4.081914 Y-8.124492 I33.926263 J-57.826188
G2 X-3.714663 Y-7.920878 I5.814809 J-10.054938
G2 X-3.465928 Y-7.794835 I3.417075 J-6.434855
G2 X-3.210106 Y-7.684382 I1.432524 J-2.966426
G2 X-3.017051 Y-7.620019 I0.836445 J-2.187163
G2 X-2.817983 Y-7.580057 I0.348047 J-1.217978
G2 X-2.643216 Y-7.575529 I0.111928 J-0.945094
G2 X-2.472136 Y-7.608452 I-0.046488 J-0.702529
G2 X-2.303799 Y-7.689086 I-0.218213 J-0.67159
G2 X-2.157335 Y-7.806088 I-0.542166 J-0.828862
G2 X-2.020876 Y-7.960031 I-0.933106 J-0.964583
G2 X-1.903228 Y-8.129313 I-1.994501 J-1.511664
G2 X-1.759883 Y-8.376391 I-2.980886 J-1.89451
G2 X-1.631122 Y-8.631584 I-7.037954 J-3.711169
G2 X-1.449983 Y-9.023837 I-11.64433 J-5.615198
G2 X-1.276252 Y-9.419493 I-91.714268 J-40.507366
G3 X-1.008743 Y-10.026484 I86.606653 J37.806255
G3 X-0.730809 Y-10.628708 I22.00102 J9.788499
G3 X-0.291645 Y-11.490025 I17.199353 J8.226902
G3 X0.199774 Y-12.322247 I11.633412 J6.308223
G3 X0.664451 Y-12.994028 I9.766039 J6.258652
G3 X1.181784 Y-13.625696 I7.140804 J5.320604
G3 X1.640448 Y-14.094942 I5.823192 J5.23309
G3 X2.141913 Y-14.517513 I4.11248 J4.371446
G3 X2.594168 Y-14.822642 I3.155408 J4.18915
G3 X3.079278 Y-15.071098 I2.062183 J3.428597
G3 X3.570441 Y-15.239561 I1.370319 J3.194992
G3 X4.082167 Y-15.32178 I0.681181 J2.606048
G3 X4.518363 Y-15.310079 I0.153102 J2.428835
G3 X4.944272 Y-15.216904 I-0.257113 J2.195301
G3 X5.382258 Y-15.019757 I-0.683468 J2.103497
G3 X5.771172 Y-14.736903 I-1.258116 J2.138661
G3 X6.122016 Y-14.362033 I-1.842337 J2.075871
G3 X6.407302 Y-13.934082 I-2.836708 J2.200112
G3 X6.64698 Y-13.437182 I-3.590666 J2.038197
G3 X6.826721 Y-12.915053 I-5.021927 J2.020779
G3 X6.976574 Y-12.265208 I-5.950171 J1.714301
G3 X7.064017 Y-11.603665 I-7.952628 J1.387736
G3 X7.101233 Y-10.773258 I-9.14265 J0.82578
G3 X7.071947 Y-9.942182 I-11.978026 J-0.006038
G3 X6.97308 Y-9.000397 I-13.633548 J-0.95515
G3 X6.819308 Y-8.065702 I-19.702787 J-2.761417
G3 X6.691508 Y-7.4335 I-25.152942 J-4.755641
G3 X6.55437 Y-6.803207 I-144.678831 J-31.148947
G2 X6.46547 Y-6.392737 I65.479765 J14.396519
G2 X6.385308 Y-5.98054 I11.359689 J2.423065
G2 X6.342298 Y-5.70503 I7.175845 J1.261352
G2 X6.316304 Y-5.427597 I3.263913 J0.445736
G2 X6.314748 Y-5.224101 I2.338592 J0.119636
G2 X6.338258 Y-5.022428 I1.265919 J-0.045364
G2 X6.387958 Y-4.854815 I0.933425 J-0.1856
G2 X6.472136 Y-4.702282 I0.653779 J-0.261306
G2 X6.600842 Y-4.567101 I0.571289 J-0.415066
G2 X6.757377 Y-4.463961 I0.620756 J-0.771763
G2 X6.945954 Y-4.381752 I0.629028 J-1.18551
G2 X7.143306 Y-4.322173 I0.821343 J-2.364013
G2 X7.422588 Y-4.262195 I0.880642 J-3.420427
G2 X7.70508 Y-4.218595 I1.354684 J-7.840306
G2 X8.13411 Y-4.167535 I1.742075 J-12.809608
G2 X8.564086 Y-4.124571 I10.183527 J-99.742916
G3 X9.224034 Y-4.057726 I-9.192957 J94.050597
G3 X9.88267 Y-3.979492 I-2.510726 J23.949026
G3 X10.83754 Y-3.827984 I-2.509357 J18.899809
G3 X11.780887 Y-3.617787 I-2.404554 J13.013381
G3 X12.563381 Y-3.383445 I-2.93446 J11.222085
G3 X13.323998 Y-3.086628 I-2.853565 J8.435466
G3 X13.912012 Y-2.795418 I-3.177499 J7.155298
G3 X14.468863 Y-2.449078 I-2.886665 J5.262052
G3 X14.898813 Y-2.113248 I-3.009043 J4.29549
G3 X15.285015 Y-1.728658 I-2.623541 J3.020747
G3 X15.597011 Y-1.313592 I-2.615166 J2.290557
G3 X15.833338 Y-0.852319 I-2.268003 J1.453154
G3 X15.957001 Y-0.433856 I-2.262649 J0.89616
G3 X16 Y0 I-2.167307 J0.433856
M2
`},circle:{about:`Circle, 10 mm radius`,program:`(Circle of R = 10 mm: x = R - R cos a, y = R sin a)
(Equation 11 of Lee, Cho, Jeon, IFAC 2005; 50 mm/s)
(One full turn from X0 Y0, exact)
G21 G17 G90 G94 G64
G0 X0 Y0
G2 X0 Y0 I10 J0 F3000
M2
`},pocket:{about:`Pocket, with rapids in Z`,program:`(Pocket 80 x 50 x 6 mm with corners of R = 8 mm, aluminium; origin: centre of the pocket, top of the part)
(T1: end mill of 10 mm, 3 flutes, 8000 rev/min)
(4 roughing levels of 1.5 mm with helix entries, floor raster, wall finish; 0.3 mm stock on the wall, 0.2 mm on the floor)
N10 G21 G17 G90 G94 G64 P0.01
N15 T1 M6
N20 S8000 M3
N25 M8
N30 G4 P1.5
N35 G0 Z5
(roughing level 1 of 4, Z-1.5)
N40 G0 X2 Y0
N45 G0 Z0.5
N50 G3 X2 Y0 Z0 I-2 J0 F600
N55 G3 X2 Y0 Z-0.5 I-2 J0 F600
N60 G3 X2 Y0 Z-1 I-2 J0 F600
N65 G3 X2 Y0 Z-1.5 I-2 J0 F600
N70 G3 X2 Y0 I-2 J0 F1800
N75 G1 X0 Y-3.7 F1800
N80 G1 X16 Y-3.7
N85 G3 X18.7 Y-1 I0 J2.7
N90 G1 X18.7 Y1
N95 G3 X16 Y3.7 I-2.7 J0
N100 G1 X-16 Y3.7
N105 G3 X-18.7 Y1 I0 J-2.7
N110 G1 X-18.7 Y-1
N115 G3 X-16 Y-3.7 I2.7 J0
N120 G1 X0 Y-3.7
N125 G1 X0 Y-7.7 F1800
N130 G1 X20 Y-7.7
N135 G3 X22.7 Y-5 I0 J2.7
N140 G1 X22.7 Y5
N145 G3 X20 Y7.7 I-2.7 J0
N150 G1 X-20 Y7.7
N155 G3 X-22.7 Y5 I0 J-2.7
N160 G1 X-22.7 Y-5
N165 G3 X-20 Y-7.7 I2.7 J0
N170 G1 X0 Y-7.7
N175 G1 X0 Y-11.7 F1800
N180 G1 X24 Y-11.7
N185 G3 X26.7 Y-9 I0 J2.7
N190 G1 X26.7 Y9
N195 G3 X24 Y11.7 I-2.7 J0
N200 G1 X-24 Y11.7
N205 G3 X-26.7 Y9 I0 J-2.7
N210 G1 X-26.7 Y-9
N215 G3 X-24 Y-11.7 I2.7 J0
N220 G1 X0 Y-11.7
N225 G1 X0 Y-15.7 F1800
N230 G1 X28 Y-15.7
N235 G3 X30.7 Y-13 I0 J2.7
N240 G1 X30.7 Y13
N245 G3 X28 Y15.7 I-2.7 J0
N250 G1 X-28 Y15.7
N255 G3 X-30.7 Y13 I0 J-2.7
N260 G1 X-30.7 Y-13
N265 G3 X-28 Y-15.7 I2.7 J0
N270 G1 X0 Y-15.7
N275 G1 X0 Y-19.7 F1800
N280 G1 X32 Y-19.7
N285 G3 X34.7 Y-17 I0 J2.7
N290 G1 X34.7 Y17
N295 G3 X32 Y19.7 I-2.7 J0
N300 G1 X-32 Y19.7
N305 G3 X-34.7 Y17 I0 J-2.7
N310 G1 X-34.7 Y-17
N315 G3 X-32 Y-19.7 I2.7 J0
N320 G1 X0 Y-19.7
N325 G0 Z5
(roughing level 2 of 4, Z-3)
N330 G0 X2 Y0
N335 G0 Z-1
N340 G3 X2 Y0 Z-1.5 I-2 J0 F600
N345 G3 X2 Y0 Z-2 I-2 J0 F600
N350 G3 X2 Y0 Z-2.5 I-2 J0 F600
N355 G3 X2 Y0 Z-3 I-2 J0 F600
N360 G3 X2 Y0 I-2 J0 F1800
N365 G1 X0 Y-3.7 F1800
N370 G1 X16 Y-3.7
N375 G3 X18.7 Y-1 I0 J2.7
N380 G1 X18.7 Y1
N385 G3 X16 Y3.7 I-2.7 J0
N390 G1 X-16 Y3.7
N395 G3 X-18.7 Y1 I0 J-2.7
N400 G1 X-18.7 Y-1
N405 G3 X-16 Y-3.7 I2.7 J0
N410 G1 X0 Y-3.7
N415 G1 X0 Y-7.7 F1800
N420 G1 X20 Y-7.7
N425 G3 X22.7 Y-5 I0 J2.7
N430 G1 X22.7 Y5
N435 G3 X20 Y7.7 I-2.7 J0
N440 G1 X-20 Y7.7
N445 G3 X-22.7 Y5 I0 J-2.7
N450 G1 X-22.7 Y-5
N455 G3 X-20 Y-7.7 I2.7 J0
N460 G1 X0 Y-7.7
N465 G1 X0 Y-11.7 F1800
N470 G1 X24 Y-11.7
N475 G3 X26.7 Y-9 I0 J2.7
N480 G1 X26.7 Y9
N485 G3 X24 Y11.7 I-2.7 J0
N490 G1 X-24 Y11.7
N495 G3 X-26.7 Y9 I0 J-2.7
N500 G1 X-26.7 Y-9
N505 G3 X-24 Y-11.7 I2.7 J0
N510 G1 X0 Y-11.7
N515 G1 X0 Y-15.7 F1800
N520 G1 X28 Y-15.7
N525 G3 X30.7 Y-13 I0 J2.7
N530 G1 X30.7 Y13
N535 G3 X28 Y15.7 I-2.7 J0
N540 G1 X-28 Y15.7
N545 G3 X-30.7 Y13 I0 J-2.7
N550 G1 X-30.7 Y-13
N555 G3 X-28 Y-15.7 I2.7 J0
N560 G1 X0 Y-15.7
N565 G1 X0 Y-19.7 F1800
N570 G1 X32 Y-19.7
N575 G3 X34.7 Y-17 I0 J2.7
N580 G1 X34.7 Y17
N585 G3 X32 Y19.7 I-2.7 J0
N590 G1 X-32 Y19.7
N595 G3 X-34.7 Y17 I0 J-2.7
N600 G1 X-34.7 Y-17
N605 G3 X-32 Y-19.7 I2.7 J0
N610 G1 X0 Y-19.7
N615 G0 Z5
(roughing level 3 of 4, Z-4.5)
N620 G0 X2 Y0
N625 G0 Z-2.5
N630 G3 X2 Y0 Z-3 I-2 J0 F600
N635 G3 X2 Y0 Z-3.5 I-2 J0 F600
N640 G3 X2 Y0 Z-4 I-2 J0 F600
N645 G3 X2 Y0 Z-4.5 I-2 J0 F600
N650 G3 X2 Y0 I-2 J0 F1800
N655 G1 X0 Y-3.7 F1800
N660 G1 X16 Y-3.7
N665 G3 X18.7 Y-1 I0 J2.7
N670 G1 X18.7 Y1
N675 G3 X16 Y3.7 I-2.7 J0
N680 G1 X-16 Y3.7
N685 G3 X-18.7 Y1 I0 J-2.7
N690 G1 X-18.7 Y-1
N695 G3 X-16 Y-3.7 I2.7 J0
N700 G1 X0 Y-3.7
N705 G1 X0 Y-7.7 F1800
N710 G1 X20 Y-7.7
N715 G3 X22.7 Y-5 I0 J2.7
N720 G1 X22.7 Y5
N725 G3 X20 Y7.7 I-2.7 J0
N730 G1 X-20 Y7.7
N735 G3 X-22.7 Y5 I0 J-2.7
N740 G1 X-22.7 Y-5
N745 G3 X-20 Y-7.7 I2.7 J0
N750 G1 X0 Y-7.7
N755 G1 X0 Y-11.7 F1800
N760 G1 X24 Y-11.7
N765 G3 X26.7 Y-9 I0 J2.7
N770 G1 X26.7 Y9
N775 G3 X24 Y11.7 I-2.7 J0
N780 G1 X-24 Y11.7
N785 G3 X-26.7 Y9 I0 J-2.7
N790 G1 X-26.7 Y-9
N795 G3 X-24 Y-11.7 I2.7 J0
N800 G1 X0 Y-11.7
N805 G1 X0 Y-15.7 F1800
N810 G1 X28 Y-15.7
N815 G3 X30.7 Y-13 I0 J2.7
N820 G1 X30.7 Y13
N825 G3 X28 Y15.7 I-2.7 J0
N830 G1 X-28 Y15.7
N835 G3 X-30.7 Y13 I0 J-2.7
N840 G1 X-30.7 Y-13
N845 G3 X-28 Y-15.7 I2.7 J0
N850 G1 X0 Y-15.7
N855 G1 X0 Y-19.7 F1800
N860 G1 X32 Y-19.7
N865 G3 X34.7 Y-17 I0 J2.7
N870 G1 X34.7 Y17
N875 G3 X32 Y19.7 I-2.7 J0
N880 G1 X-32 Y19.7
N885 G3 X-34.7 Y17 I0 J-2.7
N890 G1 X-34.7 Y-17
N895 G3 X-32 Y-19.7 I2.7 J0
N900 G1 X0 Y-19.7
N905 G0 Z5
(roughing level 4 of 4, Z-5.8)
N910 G0 X2 Y0
N915 G0 Z-4
N920 G3 X2 Y0 Z-4.45 I-2 J0 F600
N925 G3 X2 Y0 Z-4.9 I-2 J0 F600
N930 G3 X2 Y0 Z-5.35 I-2 J0 F600
N935 G3 X2 Y0 Z-5.8 I-2 J0 F600
N940 G3 X2 Y0 I-2 J0 F1800
N945 G1 X0 Y-3.7 F1800
N950 G1 X16 Y-3.7
N955 G3 X18.7 Y-1 I0 J2.7
N960 G1 X18.7 Y1
N965 G3 X16 Y3.7 I-2.7 J0
N970 G1 X-16 Y3.7
N975 G3 X-18.7 Y1 I0 J-2.7
N980 G1 X-18.7 Y-1
N985 G3 X-16 Y-3.7 I2.7 J0
N990 G1 X0 Y-3.7
N995 G1 X0 Y-7.7 F1800
N1000 G1 X20 Y-7.7
N1005 G3 X22.7 Y-5 I0 J2.7
N1010 G1 X22.7 Y5
N1015 G3 X20 Y7.7 I-2.7 J0
N1020 G1 X-20 Y7.7
N1025 G3 X-22.7 Y5 I0 J-2.7
N1030 G1 X-22.7 Y-5
N1035 G3 X-20 Y-7.7 I2.7 J0
N1040 G1 X0 Y-7.7
N1045 G1 X0 Y-11.7 F1800
N1050 G1 X24 Y-11.7
N1055 G3 X26.7 Y-9 I0 J2.7
N1060 G1 X26.7 Y9
N1065 G3 X24 Y11.7 I-2.7 J0
N1070 G1 X-24 Y11.7
N1075 G3 X-26.7 Y9 I0 J-2.7
N1080 G1 X-26.7 Y-9
N1085 G3 X-24 Y-11.7 I2.7 J0
N1090 G1 X0 Y-11.7
N1095 G1 X0 Y-15.7 F1800
N1100 G1 X28 Y-15.7
N1105 G3 X30.7 Y-13 I0 J2.7
N1110 G1 X30.7 Y13
N1115 G3 X28 Y15.7 I-2.7 J0
N1120 G1 X-28 Y15.7
N1125 G3 X-30.7 Y13 I0 J-2.7
N1130 G1 X-30.7 Y-13
N1135 G3 X-28 Y-15.7 I2.7 J0
N1140 G1 X0 Y-15.7
N1145 G1 X0 Y-19.7 F1800
N1150 G1 X32 Y-19.7
N1155 G3 X34.7 Y-17 I0 J2.7
N1160 G1 X34.7 Y17
N1165 G3 X32 Y19.7 I-2.7 J0
N1170 G1 X-32 Y19.7
N1175 G3 X-34.7 Y17 I0 J-2.7
N1180 G1 X-34.7 Y-17
N1185 G3 X-32 Y-19.7 I2.7 J0
N1190 G1 X0 Y-19.7
N1195 G0 Z5
(floor raster)
N1200 G0 X-32.73 Y-19.7
N1205 G0 Z-5.3
N1210 G1 X32.73 Z-6 F600
N1215 G1 X-32.73 F1800
N1220 G2 X-32.73 Y-15.76 I0 J1.97
N1225 G1 X32.73
N1230 G3 X32.73 Y-11.82 I0 J1.97
N1235 G1 X-32.73
N1240 G2 X-32.73 Y-7.88 I0 J1.97
N1245 G1 X32.73
N1250 G3 X32.73 Y-3.94 I0 J1.97
N1255 G1 X-32.73
N1260 G2 X-32.73 Y0 I0 J1.97
N1265 G1 X32.73
N1270 G3 X32.73 Y3.94 I0 J1.97
N1275 G1 X-32.73
N1280 G2 X-32.73 Y7.88 I0 J1.97
N1285 G1 X32.73
N1290 G3 X32.73 Y11.82 I0 J1.97
N1295 G1 X-32.73
N1300 G2 X-32.73 Y15.76 I0 J1.97
N1305 G1 X32.73
N1310 G3 X32.73 Y19.7 I0 J1.97
N1315 G1 X-32.73
N1320 G0 Z5
(wall finish)
N1325 G0 X-4 Y-16
N1330 G0 Z-5.5
N1335 G1 Z-6 F600
N1340 G3 X0 Y-20 I4 J0 F1200
N1350 G1 X32 Y-20
N1355 G3 X35 Y-17 I0 J3
N1360 G1 X35 Y17
N1365 G3 X32 Y20 I-3 J0
N1370 G1 X-32 Y20
N1375 G3 X-35 Y17 I0 J-3
N1380 G1 X-35 Y-17
N1385 G3 X-32 Y-20 I3 J0
N1390 G1 X0 Y-20
N1395 G3 X4 Y-16 I0 J4
N1400 G0 Z5
N1405 M9
N1410 M5
N1415 G0 Z50
N1420 M30
`},text:{about:`Engraved text`,program:`(Feedwright, engraved: letters of lines and arcs, 14 mm high)
G21 G17 G90 G94 G64
G0 Z2
G0 X0 Y0
G1 Z-0.3 F600
G1 X0 Y14 F1800
G1 X8 Y14
G0 Z2
G0 X0 Y7.6
G1 Z-0.3 F600
G1 X6 Y7.6 F1800
G0 Z2
G0 X19.2 Y14
G1 Z-0.3 F600
G1 X11.2 Y14 F1800
G1 X11.2 Y0
G1 X19.2 Y0
G0 Z2
G0 X11.2 Y7.6
G1 Z-0.3 F600
G1 X17.2 Y7.6 F1800
G0 Z2
G0 X30.4 Y14
G1 Z-0.3 F600
G1 X22.4 Y14 F1800
G1 X22.4 Y0
G1 X30.4 Y0
G0 Z2
G0 X22.4 Y7.6
G1 Z-0.3 F600
G1 X28.4 Y7.6 F1800
G0 Z2
G0 X33.6 Y0
G1 Z-0.3 F600
G1 X33.6 Y14 F1800
G1 X36.6 Y14
G2 X36.6 Y0 I0 J-7
G1 X33.6 Y0
G0 Z2
G0 X46.8 Y14
G1 Z-0.3 F600
G1 X49.8 Y0 F1800
G1 X52.8 Y10
G1 X55.8 Y0
G1 X58.8 Y14
G0 Z2
G0 X62 Y0
G1 Z-0.3 F600
G1 X62 Y14 F1800
G1 X66.4 Y14
G2 X66.4 Y6.8 I0 J-3.6
G1 X62 Y6.8
G0 Z2
G0 X66 Y6.8
G1 Z-0.3 F600
G1 X70 Y0 F1800
G0 Z2
G0 X73.2 Y0
G1 Z-0.3 F600
G1 X73.2 Y14 F1800
G0 Z2
G0 X87.8995 Y12.3623
G1 Z-0.3 F600
G3 X90.4 Y7 I-4.4995 J-5.3623 F1800
G1 X84.4 Y7
G0 Z2
G0 X93.6 Y0
G1 Z-0.3 F600
G1 X93.6 Y14 F1800
G0 Z2
G0 X101.6 Y0
G1 Z-0.3 F600
G1 X101.6 Y14 F1800
G0 Z2
G0 X93.6 Y7.6
G1 Z-0.3 F600
G1 X101.6 Y7.6 F1800
G0 Z2
G0 X104.8 Y14
G1 Z-0.3 F600
G1 X114.8 Y14 F1800
G0 Z2
G0 X109.8 Y14
G1 Z-0.3 F600
G1 X109.8 Y0 F1800
G0 Z2
G0 X0 Y0
M2
`}};async function f(e,t){let n=Object.entries(d).map(([e,{about:n}])=>{let r=s(`button`),i=s(`canvas`);return r.type=`button`,r.dataset.example=e,i.setAttribute(`aria-hidden`,`true`),r.append(i,s(`b`,e),s(`span`,n)),r.addEventListener(`click`,()=>t(e)),{card:r,canvas:i,name:e}});o(`cards`).replaceChildren(...n.map(({card:e})=>e));for(let{canvas:t,name:r}of n){let{points:n,kinds:i}=await e.ask({task:`check`,name:r,program:d[r].program});p(t,n,i)}}function p(e,t,n){let r=e.getContext(`2d`),i=devicePixelRatio,{clientWidth:o,clientHeight:s}=e;[e.width,e.height]=[o*i,s*i];let c=e=>t.filter((t,n)=>n%3===e),[l,u]=[c(0),c(1)],[d,f,p,m]=[Math.min(...l),Math.max(...l),Math.min(...u),Math.max(...u)],h=Math.min((o-8)/(f-d||1),(s-8)/(m-p||1));r.setTransform(i,0,0,i,o*i/2,s*i/2),r.strokeStyle=a(.1),r.lineWidth=1.5,r.beginPath(),l.forEach((e,t)=>{let i=[(e-(d+f)/2)*h,-(u[t]-(p+m)/2)*h];n[t]&1?r.lineTo(...i):r.moveTo(...i)}),r.stroke()}var m=!0,h=`uplot`,g=`u-hz`,_=`u-vt`,v=`u-title`,y=`u-wrap`,b=`u-under`,x=`u-over`,S=`u-axis`,C=`u-off`,w=`u-select`,T=`u-cursor-x`,E=`u-cursor-y`,ee=`u-cursor-pt`,te=`u-legend`,ne=`u-live`,re=`u-inline`,ie=`u-series`,ae=`u-marker`,oe=`u-label`,se=`u-value`,ce=`width`,le=`height`,ue=`top`,de=`bottom`,fe=`left`,pe=`right`,me=`#000`,he=`#0000`,ge=`mousemove`,_e=`mousedown`,ve=`mouseup`,ye=`mouseenter`,be=`mouseleave`,xe=`dblclick`,Se=`resize`,Ce=`scroll`,D=`change`,we=`dppxchange`,Te=`--`,Ee=typeof window<`u`,De=Ee?document:null,Oe=Ee?window:null,O=Ee?navigator:null,k,ke;function A(){let e=devicePixelRatio;k!=e&&(k=e,ke&&He(D,ke,A),ke=matchMedia(`(min-resolution: ${k-.001}dppx) and (max-resolution: ${k+.001}dppx)`),Ve(D,ke,A),Oe.dispatchEvent(new CustomEvent(we)))}function Ae(e,t){if(t!=null){let n=e.classList;!n.contains(t)&&n.add(t)}}function je(e,t){let n=e.classList;n.contains(t)&&n.remove(t)}function j(e,t,n){e.style[t]=n+`px`}function Me(e,t,n,r){let i=De.createElement(e);return t!=null&&Ae(i,t),n?.insertBefore(i,r),i}function Ne(e,t){return Me(`div`,e,t)}var Pe=new WeakMap;function Fe(e,t,n,r,i){let a=`translate(`+t+`px,`+n+`px)`;a!=Pe.get(e)&&(e.style.transform=a,Pe.set(e,a),t<0||n<0||t>r||n>i?Ae(e,C):je(e,C))}var Ie=new WeakMap;function Le(e,t,n){let r=t+n;r!=Ie.get(e)&&(Ie.set(e,r),e.style.background=t,e.style.borderColor=n)}var Re=new WeakMap;function ze(e,t,n,r){let i=t+``+n;i!=Re.get(e)&&(Re.set(e,i),e.style.height=n+`px`,e.style.width=t+`px`,e.style.marginLeft=r?-t/2+`px`:0,e.style.marginTop=r?-n/2+`px`:0)}var Be={passive:!0},M={...Be,capture:!0};function Ve(e,t,n,r){t.addEventListener(e,n,r?M:Be)}function He(e,t,n,r){t.removeEventListener(e,n,Be)}Ee&&A();function Ue(e,t,n,r){let i;n||=0,r||=t.length-1;let a=r<=2147483647;for(;r-n>1;)i=a?n+r>>1:I((n+r)/2),t[i]<e?n=i:r=i;return e-t[n]<=t[r]-e?n:r}function We(e){return(t,n,r)=>{let i=-1,a=-1;for(let a=n;a<=r;a++)if(e(t[a])){i=a;break}for(let i=r;i>=n;i--)if(e(t[i])){a=i;break}return[i,a]}}var Ge=e=>e!=null,Ke=e=>e!=null&&e>0,N=We(Ge),qe=We(Ke);function Je(e,t,n,r=0,i=!1){let a=i?qe:N,o=i?Ke:Ge;[t,n]=a(e,t,n);let s=e[t],c=e[t];if(t>-1){if(r==1)s=e[t],c=e[n];else if(r==-1)s=e[n],c=e[t];else for(let r=t;r<=n;r++){let t=e[r];o(t)&&(t<s?s=t:t>c&&(c=t))}}return[s??L,c??-L]}function Ye(e,t,n,r){let i=pt(e),a=pt(t);e==t&&(i==-1?(e*=n,t/=n):(e/=n,t*=n));let o=n==10?mt:ht,s=i==1?I:lt,c=a==1?lt:I,l=s(o(st(e))),u=c(o(st(t))),d=ft(n,l),f=ft(n,u);return n==10&&(l<0&&(d=z(d,-l)),u<0&&(f=z(f,-u))),r||n==2?(e=d*i,t=f*a):(e=jt(e,d),t=At(t,f)),[e,t]}function Xe(e,t,n,r){let i=Ye(e,t,n,r);return e==0&&(i[0]=0),t==0&&(i[1]=0),i}var Ze=.1,Qe={mode:3,pad:Ze},$e={pad:0,soft:null,mode:0},et={min:$e,max:$e};function tt(e,t,n,r){return Ht(n)?rt(e,t,n):($e.pad=n,$e.soft=r?0:null,$e.mode=r?3:0,rt(e,t,et))}function P(e,t){return e??t}function nt(e,t,n){for(t=P(t,0),n=P(n,e.length-1);t<=n;){if(e[t]!=null)return!0;t++}return!1}function rt(e,t,n){let r=n.min,i=n.max,a=P(r.pad,0),o=P(i.pad,0),s=P(r.hard,-L),c=P(i.hard,L),l=P(r.soft,L),u=P(i.soft,-L),d=P(r.mode,0),f=P(i.mode,0),p=t-e,m=mt(p),h=dt(st(e),st(t)),g=st(mt(h)-m);(p<1e-24||g>10)&&(p=0,(e==0||t==0)&&(p=1e-24,d==2&&l!=L&&(a=0),f==2&&u!=-L&&(o=0)));let _=p||h||1e3,v=ft(10,I(mt(_))),y=z(jt(e-_*(p==0?e==0?.1:1:a),v/10),24),b=e>=l&&(d==1||d==3&&y<=l||d==2&&y>=l)?l:L,x=dt(s,y<b&&e>=b?b:ut(b,y)),S=z(At(t+_*(p==0?t==0?.1:1:o),v/10),24),C=t<=u&&(f==1||f==3&&S>=u||f==2&&S<=u)?u:-L,w=ut(c,S>C&&t<=C?C:dt(C,S));return x==w&&x==0&&(w=100),[x,w]}var it=new Intl.NumberFormat(Ee?O.language:`en-US`),at=e=>it.format(e),F=Math,ot=F.PI,st=F.abs,I=F.floor,ct=F.round,lt=F.ceil,ut=F.min,dt=F.max,ft=F.pow,pt=F.sign,mt=F.log10,ht=F.log2,gt=(e,t=1)=>F.sinh(e)*t,_t=(e,t=1)=>F.asinh(e/t),L=1/0;function vt(e){return(mt((e^e>>31)-(e>>31))|0)+1}function yt(e,t,n){return ut(dt(e,t),n)}function bt(e){return typeof e==`function`}function R(e){return bt(e)?e:()=>e}var xt=()=>{},St=e=>e,Ct=(e,t)=>t,wt=e=>null,Tt=e=>!0,Et=(e,t)=>e==t,Dt=/\.\d*?(?=9{6,}|0{6,})/gm,Ot=e=>{if(zt(e)||Mt.has(e))return e;let t=`${e}`,n=t.match(Dt);if(n==null)return e;let r=n[0].length-1;if(t.indexOf(`e-`)!=-1){let[e,n]=t.split(`e`);return+`${Ot(e)}e${n}`}return z(e,r)};function kt(e,t){return Ot(z(Ot(e/t))*t)}function At(e,t){return Ot(lt(Ot(e/t))*t)}function jt(e,t){return Ot(I(Ot(e/t))*t)}function z(e,t=0){if(zt(e))return e;let n=10**t;return ct(e*n*(1+2**-52))/n}var Mt=new Map;function Nt(e){return((``+e).split(`.`)[1]||``).length}function Pt(e,t,n,r){let i=[],a=r.map(Nt);for(let o=t;o<n;o++){let t=st(o),n=z(ft(e,o),t);for(let s=0;s<r.length;s++){let c=e==10?+`${r[s]}e${o}`:r[s]*n,l=(o>=0?0:t)+(o>=a[s]?0:a[s]),u=e==10?c:z(c,l);i.push(u),Mt.set(u,l)}}return i}var Ft={},It=[],Lt=[null,null],Rt=Array.isArray,zt=Number.isInteger,Bt=e=>e===void 0;function Vt(e){return typeof e==`string`}function Ht(e){let t=!1;if(e!=null){let n=e.constructor;t=n==null||n==Object}return t}function Ut(e){return typeof e==`object`&&!!e}var Wt=Object.getPrototypeOf(Uint8Array),Gt=`__proto__`;function Kt(e,t=Ht){let n;if(Rt(e)){let r=e.find(e=>e!=null);if(Rt(r)||t(r)){n=Array(e.length);for(let r=0;r<e.length;r++)n[r]=Kt(e[r],t)}else n=e.slice()}else if(e instanceof Wt)n=e.slice();else if(t(e)){n={};for(let r in e)r!=Gt&&(n[r]=Kt(e[r],t))}else n=e;return n}function B(e){let t=arguments;for(let n=1;n<t.length;n++){let r=t[n];for(let t in r)t!=Gt&&(Ht(e[t])?B(e[t],Kt(r[t])):e[t]=Kt(r[t]))}return e}var qt=0,Jt=1,Yt=2;function Xt(e,t,n){for(let r=0,i,a=-1;r<t.length;r++){let o=t[r];if(o>a){for(i=o-1;i>=0&&e[i]==null;)e[i--]=null;for(i=o+1;i<n&&e[i]==null;)e[a=i++]=null}}}function Zt(e,t){if(en(e)){let t=e[0].slice();for(let n=1;n<e.length;n++)t.push(...e[n].slice(1));return V(t[0])||(t=$t(t)),t}let n=new Set;for(let t=0;t<e.length;t++){let r=e[t][0],i=r.length;for(let e=0;e<i;e++)n.add(r[e])}let r=[Array.from(n).sort((e,t)=>e-t)],i=r[0].length,a=new Map;for(let e=0;e<i;e++)a.set(r[0][e],e);for(let n=0;n<e.length;n++){let o=e[n],s=o[0];for(let e=1;e<o.length;e++){let c=o[e],l=Array(i).fill(void 0),u=t?t[n][e]:Jt,d=[];for(let e=0;e<c.length;e++){let t=c[e],n=a.get(s[e]);t===null?u!=qt&&(l[n]=t,u==Yt&&d.push(n)):l[n]=t}Xt(l,d,i),r.push(l)}}return r}var Qt=typeof queueMicrotask>`u`?e=>Promise.resolve().then(e):queueMicrotask;function $t(e){let t=e[0],n=t.length,r=Array(n);for(let e=0;e<r.length;e++)r[e]=e;r.sort((e,n)=>t[e]-t[n]);let i=[];for(let t=0;t<e.length;t++){let a=e[t],o=Array(n);for(let e=0;e<n;e++)o[e]=a[r[e]];i.push(o)}return i}function en(e){let t=e[0][0],n=t.length;for(let r=1;r<e.length;r++){let i=e[r][0];if(i.length!=n)return!1;if(i!=t){for(let e=0;e<n;e++)if(i[e]!=t[e])return!1}}return!0}function V(e,t=100){let n=e.length;if(n<=1)return!0;let r=0,i=n-1;for(;r<=i&&e[r]==null;)r++;for(;i>=r&&e[i]==null;)i--;if(i<=r)return!0;let a=dt(1,I((i-r+1)/t));for(let t=e[r],n=r+a;n<=i;n+=a){let r=e[n];if(r!=null){if(r<=t)return!1;t=r}}return!0}var H=[`January`,`February`,`March`,`April`,`May`,`June`,`July`,`August`,`September`,`October`,`November`,`December`],tn=[`Sunday`,`Monday`,`Tuesday`,`Wednesday`,`Thursday`,`Friday`,`Saturday`];function nn(e){return e.slice(0,3)}var rn=tn.map(nn),an={MMMM:H,MMM:H.map(nn),WWWW:tn,WWW:rn};function on(e){return(e<10?`0`:``)+e}function sn(e){return(e<10?`00`:e<100?`0`:``)+e}var cn={YYYY:e=>e.getFullYear(),YY:e=>(e.getFullYear()+``).slice(2),MMMM:(e,t)=>t.MMMM[e.getMonth()],MMM:(e,t)=>t.MMM[e.getMonth()],MM:e=>on(e.getMonth()+1),M:e=>e.getMonth()+1,DD:e=>on(e.getDate()),D:e=>e.getDate(),WWWW:(e,t)=>t.WWWW[e.getDay()],WWW:(e,t)=>t.WWW[e.getDay()],HH:e=>on(e.getHours()),H:e=>e.getHours(),h:e=>{let t=e.getHours();return t==0?12:t>12?t-12:t},AA:e=>e.getHours()>=12?`PM`:`AM`,aa:e=>e.getHours()>=12?`pm`:`am`,a:e=>e.getHours()>=12?`p`:`a`,mm:e=>on(e.getMinutes()),m:e=>e.getMinutes(),ss:e=>on(e.getSeconds()),s:e=>e.getSeconds(),fff:e=>sn(e.getMilliseconds())};function ln(e,t){t||=an;let n=[],r=/\{([a-z]+)\}|[^{]+/gi,i;for(;i=r.exec(e);)n.push(i[0][0]==`{`?cn[i[1]]:i[0]);return e=>{let r=``;for(let i=0;i<n.length;i++)r+=typeof n[i]==`string`?n[i]:n[i](e,t);return r}}var un=new Intl.DateTimeFormat().resolvedOptions().timeZone;function dn(e,t){let n;return t==`UTC`||t==`Etc/UTC`?n=new Date(+e+e.getTimezoneOffset()*6e4):t==un?n=e:(n=new Date(e.toLocaleString(`en-US`,{timeZone:t})),n.setMilliseconds(e.getMilliseconds())),n}var fn=e=>e%1==0,pn=[1,2,2.5,5],mn=Pt(10,-32,0,pn),hn=Pt(10,0,32,pn),gn=hn.filter(fn),_n=mn.concat(hn),vn=`
`,yn=`{YYYY}`,bn=vn+yn,xn=`{M}/{D}`,Sn=vn+xn,Cn=Sn+`/{YY}`,wn=`{aa}`,Tn=`{h}:{mm}`+wn,En=vn+Tn,Dn=`:{ss}`,U=null;function On(e){let t=e*1e3,n=t*60,r=n*60,i=r*24,a=i*30,o=i*365,s=(e==1?Pt(10,0,3,pn).filter(fn):Pt(10,-3,0,pn)).concat([t,t*5,t*10,t*15,t*30,n,n*5,n*10,n*15,n*30,r,r*2,r*3,r*4,r*6,r*8,r*12,i,i*2,i*3,i*4,i*5,i*6,i*7,i*8,i*9,i*10,i*15,a,a*2,a*3,a*4,a*6,o,o*2,o*5,o*10,o*25,o*50,o*100]),c=[[o,yn,U,U,U,U,U,U,1],[i*28,`{MMM}`,bn,U,U,U,U,U,1],[i,xn,bn,U,U,U,U,U,1],[r,`{h}`+wn,Cn,U,Sn,U,U,U,1],[n,Tn,Cn,U,Sn,U,U,U,1],[t,Dn,Cn+` `+Tn,U,Sn+` `+Tn,U,En,U,1],[e,Dn+`.{fff}`,Cn+` `+Tn,U,Sn+` `+Tn,U,En,U,1]];function l(t){return(s,c,l,u,d,f)=>{let p=[],m=d>=o,h=d>=a&&d<o,g=t(l),_=z(g*e,3),v=Rn(g.getFullYear(),m?0:g.getMonth(),h||m?1:g.getDate()),y=z(v*e,3);if(h||m){let n=h?d/a:0,r=m?d/o:0,i=_==y?_:z(Rn(v.getFullYear()+r,v.getMonth()+n,1)*e,3),s=new Date(ct(i/e)),c=s.getFullYear(),l=s.getMonth();for(let a=0;i<=u;a++){let o=Rn(c+r*a,l+n*a,1),s=o-t(z(o*e,3));i=z((+o+s)*e,3),i<=u&&p.push(i)}}else{let a=d>=i?i:d,o=y+(I(l)-I(_))+At(_-y,a);p.push(o);let m=t(o),h=m.getHours()+m.getMinutes()/n+m.getSeconds()/r,g=d/r,v=f/s.axes[c]._space;for(;o=z(o+d,e==1?0:3),!(o>u);)if(g>1){let e=I(z(h+g,6))%24,n=t(o).getHours()-e;n>1&&(n=-1),o-=n*r,h=(h+g)%24;let i=p[p.length-1];z((o-i)/d,3)*v>=.7&&p.push(o)}else p.push(o)}return p}}return[s,c,l]}var[kn,An,jn]=On(1),[Mn,Nn,Pn]=On(.001);Pt(2,-53,53,[1]);function Fn(e,t){return e.map(e=>e.map((n,r)=>r==0||r==8||n==null?n:t(r==1||e[8]==0?n:e[1]+n)))}function In(e,t){return(n,r,i,a,o)=>{let s=t.find(e=>o>=e[0])||t[t.length-1],c,l,u,d,f,p;return r.map(t=>{let n=e(t),r=n.getFullYear(),i=n.getMonth(),a=n.getDate(),o=n.getHours(),m=n.getMinutes(),h=n.getSeconds(),g=r!=c&&s[2]||i!=l&&s[3]||a!=u&&s[4]||o!=d&&s[5]||m!=f&&s[6]||h!=p&&s[7]||s[1];return c=r,l=i,u=a,d=o,f=m,p=h,g(n)})}}function Ln(e,t){let n=ln(t);return(t,r,i,a,o)=>r.map(t=>n(e(t)))}function Rn(e,t,n){return new Date(e,t,n)}function zn(e,t){return t(e)}var Bn=`{YYYY}-{MM}-{DD} {h}:{mm}{aa}`;function Vn(e,t){return(n,r,i,a)=>a==null?Te:t(e(r))}function Hn(e,t){let n=e.series[t];return n.width?n.stroke(e,t):n.points.width?n.points.stroke(e,t):null}function Un(e,t){return e.series[t].fill(e,t)}var Wn={show:!0,live:!0,isolate:!1,mount:xt,markers:{show:!0,width:2,stroke:Hn,fill:Un,dash:`solid`},idx:null,idxs:null,values:[]};function Gn(e,t){let n=e.cursor.points,r=Ne(),i=n.size(e,t);j(r,ce,i),j(r,le,i);let a=i/-2;j(r,`marginLeft`,a),j(r,`marginTop`,a);let o=n.width(e,t,i);return o&&j(r,`borderWidth`,o),r}function Kn(e,t){let n=e.series[t].points;return n._fill||n._stroke}function qn(e,t){let n=e.series[t].points;return n._stroke||n._fill}function Jn(e,t){return e.series[t].points.size}var Yn=[0,0];function Xn(e,t,n){return Yn[0]=t,Yn[1]=n,Yn}function Zn(e,t,n,r=!0){return e=>{e.button!=0||r&&e.target!=t||n(e)}}function Qn(e,t,n,r=!0){return e=>{r&&e.target!=t||n(e)}}var $n={show:!0,x:!0,y:!0,lock:!1,move:Xn,points:{one:!1,show:Gn,size:Jn,width:0,stroke:qn,fill:Kn},bind:{mousedown:Zn,mouseup:Zn,click:Zn,dblclick:Zn,mousemove:Qn,mouseleave:Qn,mouseenter:Qn},drag:{setScale:!0,x:!0,y:!1,dist:0,uni:null,click:(e,t)=>{t.stopPropagation(),t.stopImmediatePropagation()},_x:!1,_y:!1},focus:{dist:(e,t,n,r,i)=>r-i,prox:-1,bias:0},hover:{skip:[void 0],prox:null,bias:0},left:-10,top:-10,idx:null,dataIdx:null,idxs:null,event:null},er={show:!0,stroke:`rgba(0,0,0,0.07)`,width:2},tr=B({},er,{filter:Ct}),nr=B({},tr,{size:10}),rr=B({},er,{show:!1}),W=`12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, "Noto Sans", sans-serif, "Apple Color Emoji", "Segoe UI Emoji", "Segoe UI Symbol", "Noto Color Emoji"`,G=`bold `+W,ir=1.5,ar={show:!0,scale:`x`,stroke:me,space:50,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:G,side:2,grid:tr,ticks:nr,border:rr,font:W,lineGap:ir,rotate:0},or=`Value`,sr=`Time`,cr={show:!0,scale:`x`,auto:!1,sorted:1,min:L,max:-1/0,idxs:[]};function lr(e,t,n,r,i){return t.map(e=>e==null?``:at(e))}function ur(e,t,n,r,i,a,o){let s=[],c=Mt.get(i)||0;n=o?n:z(At(n,i),c);for(let e=n;e<=r;e=z(e+i,c))s.push(Object.is(e,-0)?0:e);return s}function dr(e,t,n,r,i,a,o){let s=[],c=e.scales[e.axes[t].scale].log;i=ft(c,I((c==10?mt:ht)(n))),c==10&&(i=_n[Ue(i,_n)]);let l=n,u=i*c;c==10&&(u=_n[Ue(u,_n)]);do s.push(l),l+=i,c==10&&!Mt.has(l)&&(l=z(l,Mt.get(i))),l>=u&&(i=l,u=i*c,c==10&&(u=_n[Ue(u,_n)]));while(l<=r);return s}function fr(e,t,n,r,i,a,o){let s=e.scales[e.axes[t].scale].asinh,c=r>s?dr(e,t,dt(s,n),r,i):[s],l=r>=0&&n<=0?[0]:[];return(n<-s?dr(e,t,dt(s,-r),-n,i):[s]).reverse().map(e=>-e).concat(l,c)}var pr=/./,mr=/[12357]/,hr=/[125]/,gr=/1/,_r=(e,t,n,r)=>e.map((e,i)=>t==4&&e==0||i%r==0&&n.test(e.toExponential()[+(e<0)])?e:null);function vr(e,t,n,r,i){let a=e.axes[n],o=a.scale,s=e.scales[o],c=e.valToPos,l=a._space,u=c(10,o),d=c(9,o)-u>=l?pr:c(7,o)-u>=l?mr:c(5,o)-u>=l?hr:gr;if(d==gr){let e=st(c(1,o)-u);if(e<l)return _r(t.slice().reverse(),s.distr,d,lt(l/e)).reverse()}return _r(t,s.distr,d,1)}function yr(e,t,n,r,i){let a=e.axes[n],o=a.scale,s=a._space,c=e.valToPos,l=st(c(1,o)-c(2,o));return l<s?_r(t.slice().reverse(),3,pr,lt(s/l)).reverse():t}function br(e,t,n,r){return r==null?Te:t==null?``:at(t)}var xr={show:!0,scale:`y`,stroke:me,space:30,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:G,side:3,grid:tr,ticks:nr,border:rr,font:W,lineGap:ir,rotate:0};function Sr(e,t){return z((3+(e||1)*2)*t,3)}function Cr(e,t){let{scale:n,idxs:r}=e.series[0],i=e._data[0],a=e.valToPos(i[r[0]],n,!0),o=st(e.valToPos(i[r[1]],n,!0)-a)/(e.series[t].points.space*k);return r[1]-r[0]<=o}var wr={scale:null,auto:!0,sorted:0,min:L,max:-1/0},Tr=(e,t,n,r,i)=>i,Er={show:!0,auto:!0,sorted:0,gaps:Tr,alpha:1,facets:[B({},wr,{scale:`x`}),B({},wr,{scale:`y`})]},Dr={scale:`y`,auto:!0,sorted:0,show:!0,spanGaps:!1,gaps:Tr,alpha:1,points:{show:Cr,filter:null},values:null,min:L,max:-1/0,idxs:[],path:null,clip:null};function Or(e,t,n,r,i){return n/10}var kr={time:m,auto:!0,distr:1,log:10,asinh:1,min:null,max:null,dir:1,ori:0},Ar=B({},kr,{time:!1,ori:1}),jr={};function Mr(e,t){let n=jr[e];return n||(n={key:e,plots:[],sub(e){n.plots.push(e)},unsub(e){n.plots=n.plots.filter(t=>t!=e)},pub(e,t,r,i,a,o,s){for(let c=0;c<n.plots.length;c++)n.plots[c]!=t&&n.plots[c].pub(e,t,r,i,a,o,s)}},e!=null&&(jr[e]=n)),n}var Nr=1,Pr=2;function Fr(e,t,n){let r=e.mode,i=e.series[t],a=r==2?e._data[t]:e._data,o=e.scales,s=e.bbox,c=a[0],l=r==2?a[1]:a[t],u=r==2?o[i.facets[0].scale]:o[e.series[0].scale],d=r==2?o[i.facets[1].scale]:o[i.scale],f=s.left,p=s.top,m=s.width,h=s.height,g=e.valToPosH,_=e.valToPosV;return u.ori==0?n(i,c,l,u,d,g,_,f,p,m,h,Wr,Kr,Jr,Xr,Qr):n(i,c,l,u,d,_,g,p,f,h,m,Gr,qr,Yr,Zr,$r)}function Ir(e,t){let n=0,r=0,i=P(e.bands,It);for(let e=0;e<i.length;e++){let a=i[e];a.series[0]==t?n=a.dir:a.series[1]==t&&(a.dir==1?r|=1:r|=2)}return[n,r==1?-1:r==2?1:r==3?2:0]}function Lr(e,t,n,r,i){let a=e.mode,o=e.series[t],s=a==2?o.facets[1].scale:o.scale,c=e.scales[s];return i==-1?c.min:i==1?c.max:c.distr==3?c.dir==1?c.min:c.max:0}function Rr(e,t,n,r,i,a){return Fr(e,t,(e,t,o,s,c,l,u,d,f,p,m)=>{let h=e.pxRound,g=s.dir*(s.ori==0?1:-1),_=s.ori==0?Kr:qr,v,y;g==1?(v=n,y=r):(v=r,y=n);let b=h(l(t[v],s,p,d)),x=h(u(o[v],c,m,f)),S=h(l(t[y],s,p,d)),C=h(u(a==1?c.max:c.min,c,m,f)),w=new Path2D(i);return _(w,S,C),_(w,b,C),_(w,b,x),w})}function zr(e,t,n,r,i,a){let o=null;if(e.length>0){o=new Path2D;let s=t==0?Jr:Yr,c=n;for(let t=0;t<e.length;t++){let n=e[t];if(n[1]>n[0]){let e=n[0]-c;e>0&&s(o,c,r,e,r+a),c=n[1]}}let l=n+i-c;l>0&&s(o,c,r-5,l,r+a+10)}return o}function Br(e,t,n){let r=e[e.length-1];r&&r[0]==t?r[1]=n:e.push([t,n])}function Vr(e,t,n,r,i,a,o){let s=[],c=e.length;for(let l=i==1?n:r;l>=n&&l<=r;l+=i)if(t[l]===null){let u=l,d=l;if(i==1)for(;++l<=r&&t[l]===null;)d=l;else for(;--l>=n&&t[l]===null;)d=l;let f=a(e[u]),p=d==u?f:a(e[d]),m=u-i;f=o<=0&&m>=0&&m<c?a(e[m]):f;let h=d+i;p=o>=0&&h>=0&&h<c?a(e[h]):p,p>=f&&s.push([f,p])}return s}function Hr(e){return e==0?St:e==1?ct:t=>kt(t,e)}function Ur(e){let t=e==0?Wr:Gr,n=e==0?(e,t,n,r,i,a)=>{e.arcTo(t,n,r,i,a)}:(e,t,n,r,i,a)=>{e.arcTo(n,t,i,r,a)},r=e==0?(e,t,n,r,i)=>{e.rect(t,n,r,i)}:(e,t,n,r,i)=>{e.rect(n,t,i,r)};return(e,i,a,o,s,c=0,l=0)=>{c==0&&l==0?r(e,i,a,o,s):(c=ut(c,o/2,s/2),l=ut(l,o/2,s/2),t(e,i+c,a),n(e,i+o,a,i+o,a+s,c),n(e,i+o,a+s,i,a+s,l),n(e,i,a+s,i,a,l),n(e,i,a,i+o,a,c),e.closePath())}}var Wr=(e,t,n)=>{e.moveTo(t,n)},Gr=(e,t,n)=>{e.moveTo(n,t)},Kr=(e,t,n)=>{e.lineTo(t,n)},qr=(e,t,n)=>{e.lineTo(n,t)},Jr=Ur(0),Yr=Ur(1),Xr=(e,t,n,r,i,a)=>{e.arc(t,n,r,i,a)},Zr=(e,t,n,r,i,a)=>{e.arc(n,t,r,i,a)},Qr=(e,t,n,r,i,a,o)=>{e.bezierCurveTo(t,n,r,i,a,o)},$r=(e,t,n,r,i,a,o)=>{e.bezierCurveTo(n,t,i,r,o,a)};function ei(e){return(e,t,n,r,i)=>Fr(e,t,(t,a,o,s,c,l,u,d,f,p,m)=>{let{pxRound:h,points:g}=t,_,v;s.ori==0?(_=Wr,v=Xr):(_=Gr,v=Zr);let y=z(g.width*k,3),b=(g.size-g.width)/2*k,x=z(b*2,3),S=new Path2D,C=new Path2D,{left:w,top:T,width:E,height:ee}=e.bbox;Jr(C,w-x,T-x,E+x*2,ee+x*2);let te=e=>{if(o[e]!=null){let t=h(l(a[e],s,p,d)),n=h(u(o[e],c,m,f));_(S,t+b,n),v(S,t,n,b,0,ot*2)}};if(i)i.forEach(te);else for(let e=n;e<=r;e++)te(e);return{stroke:y>0?S:null,fill:S,clip:C,flags:3}})}function ti(e){return(t,n,r,i,a,o)=>{r!=i&&(a!=r&&o!=r&&e(t,n,r),a!=i&&o!=i&&e(t,n,i),e(t,n,o))}}var ni=ti(Kr),ri=ti(qr);function ii(e){let t=P(e?.alignGaps,0);return(e,n,r,i)=>Fr(e,n,(a,o,s,c,l,u,d,f,p,m,h)=>{[r,i]=N(s,r,i);let g=a.pxRound,_=e=>g(u(e,c,m,f)),v=e=>g(d(e,l,h,p)),y,b;c.ori==0?(y=Kr,b=ni):(y=qr,b=ri);let x=c.dir*(c.ori==0?1:-1),S={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Nr},C=S.stroke,w=!1;if(i-r>=m*4){let t=t=>e.posToVal(t,c.key,!0),n=null,a=null,l,u,d,f=_(o[x==1?r:i]),p=_(o[r]),m=_(o[i]),h=t(x==1?p+1:m-1);for(let e=x==1?r:i;e>=r&&e<=i;e+=x){let r=o[e],i=(x==1?r<h:r>h)?f:_(r),c=s[e];i==f?c==null?c===null&&(w=!0):(u=c,n==null?(y(C,i,v(u)),l=n=a=u):u<n?n=u:u>a&&(a=u)):(n!=null&&b(C,f,v(n),v(a),v(l),v(u)),c==null?(n=a=null,c===null&&(w=!0)):(u=c,y(C,i,v(u)),n=a=l=u),f=i,h=t(f+x))}n!=null&&n!=a&&d!=f&&b(C,f,v(n),v(a),v(l),v(u))}else for(let e=x==1?r:i;e>=r&&e<=i;e+=x){let t=s[e];t===null?w=!0:t!=null&&y(C,_(o[e]),v(t))}let[T,E]=Ir(e,n);if(a.fill!=null||T!=0){let t=S.fill=new Path2D(C),s=v(a.fillTo(e,n,a.min,a.max,T)),c=_(o[r]),l=_(o[i]);x==-1&&([l,c]=[c,l]),y(t,l,s),y(t,c,s)}if(!a.spanGaps){let l=[];w&&l.push(...Vr(o,s,r,i,x,_,t)),S.gaps=l=a.gaps(e,n,r,i,l),S.clip=zr(l,c.ori,f,p,m,h)}return E!=0&&(S.band=E==2?[Rr(e,n,r,i,C,-1),Rr(e,n,r,i,C,1)]:Rr(e,n,r,i,C,E)),S})}function ai(e){let t=P(e.align,1),n=P(e.ascDesc,!1),r=P(e.alignGaps,0),i=P(e.extend,!1);return(e,a,o,s)=>Fr(e,a,(c,l,u,d,f,p,m,h,g,_,v)=>{[o,s]=N(u,o,s);let y=c.pxRound,{left:b,width:x}=e.bbox,S=e=>y(p(e,d,_,h)),C=e=>y(m(e,f,v,g)),w=d.ori==0?Kr:qr,T={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Nr},E=T.stroke,ee=d.dir*(d.ori==0?1:-1),te=C(u[ee==1?o:s]),ne=S(l[ee==1?o:s]),re=ne,ie=ne;i&&t==-1&&(ie=b,w(E,ie,te)),w(E,ne,te);for(let e=ee==1?o:s;e>=o&&e<=s;e+=ee){let n=u[e];if(n==null)continue;let r=S(l[e]),i=C(n);t==1?w(E,r,te):w(E,re,i),w(E,r,i),te=i,re=r}let ae=re;i&&t==1&&(ae=b+x,w(E,ae,te));let[oe,se]=Ir(e,a);if(c.fill!=null||oe!=0){let t=T.fill=new Path2D(E),n=C(c.fillTo(e,a,c.min,c.max,oe));w(t,ae,n),w(t,ie,n)}if(!c.spanGaps){let i=[];i.push(...Vr(l,u,o,s,ee,S,r));let f=c.width*k/2,p=n||t==1?f:-f,m=n||t==-1?-f:f;i.forEach(e=>{e[0]+=p,e[1]+=m}),T.gaps=i=c.gaps(e,a,o,s,i),T.clip=zr(i,d.ori,h,g,_,v)}return se!=0&&(T.band=se==2?[Rr(e,a,o,s,E,-1),Rr(e,a,o,s,E,1)]:Rr(e,a,o,s,E,se)),T})}function oi(e,t,n,r,i,a,o=L){if(e.length>1){let s=null;for(let c=0,l=1/0;c<e.length;c++)if(t[c]!==void 0){if(s!=null){let t=st(e[c]-e[s]);t<l&&(l=t,o=st(n(e[c],r,i,a)-n(e[s],r,i,a)))}s=c}}return o}function si(e){e||=Ft;let t=P(e.size,[.6,L,1]),n=e.align||0,r=e.gap||0,i=e.radius;i=i==null?[0,0]:typeof i==`number`?[i,0]:i;let a=R(i),o=1-t[0],s=P(t[1],L),c=P(t[2],1),l=P(e.disp,Ft),u=P(e.each,e=>{}),{fill:d,stroke:f}=l;return(e,t,i,p)=>Fr(e,t,(m,h,g,_,v,y,b,x,S,C,w)=>{let T=m.pxRound,E=n,ee=r*k,te=s*k,ne=c*k,re,ie;_.ori==0?[re,ie]=a(e,t):[ie,re]=a(e,t);let ae=_.dir*(_.ori==0?1:-1),oe=_.ori==0?Jr:Yr,se=_.ori==0?u:(e,t,n,r,i,a,o)=>{u(e,t,n,i,r,o,a)},ce=P(e.bands,It).find(e=>e.series[0]==t),le=ce==null?0:ce.dir,ue=m.fillTo(e,t,m.min,m.max,le),de=T(b(ue,v,w,S)),fe,pe,me,he=C,ge=T(m.width*k),_e=!1,ve=null,ye=null,be=null,xe=null;d!=null&&(ge==0||f!=null)&&(_e=!0,ve=d.values(e,t,i,p),ye=new Map,new Set(ve).forEach(e=>{e!=null&&ye.set(e,new Path2D)}),ge>0&&(be=f.values(e,t,i,p),xe=new Map,new Set(be).forEach(e=>{e!=null&&xe.set(e,new Path2D)})));let{x0:Se,size:Ce}=l;if(Se!=null&&Ce!=null){E=1,h=Se.values(e,t,i,p),Se.unit==2&&(h=h.map(t=>e.posToVal(x+t*C,_.key,!0)));let n=Ce.values(e,t,i,p);pe=Ce.unit==2?n[0]*C:y(n[0],_,C,x)-y(0,_,C,x),he=oi(h,g,y,_,C,x,he),me=he-pe+ee}else he=oi(h,g,y,_,C,x,he),me=he*o+ee,pe=he-me;me<1&&(me=0),ge>=pe/2&&(ge=0),me<5&&(T=St);let D=me>0,we=he-me-(D?ge:0);pe=T(yt(we,ne,te)),fe=(E==0?pe/2:E==ae?0:pe)-E*ae*((E==0?ee/2:0)+(D?ge/2:0));let Te={stroke:null,fill:null,clip:null,band:null,gaps:null,flags:0},Ee=_e?null:new Path2D,De=null;if(ce!=null)De=e.data[ce.series[1]];else{let{y0:n,y1:r}=l;n!=null&&r!=null&&(g=r.values(e,t,i,p),De=n.values(e,t,i,p))}let Oe=re*pe,O=ie*pe;for(let n=ae==1?i:p;n>=i&&n<=p;n+=ae){let r=g[n];if(r==null)continue;if(De!=null){let e=De[n]??0;if(r-e==0)continue;de=b(e,v,w,S)}let i=y(_.distr!=2||l!=null?h[n]:n,_,C,x),a=b(P(r,ue),v,w,S),o=T(i-fe),s=T(dt(a,de)),c=T(ut(a,de)),u=s-c;if(r!=null){let i=r<0?O:Oe,a=r<0?Oe:O;_e?(ge>0&&be[n]!=null&&oe(xe.get(be[n]),o,c+I(ge/2),pe,dt(0,u-ge),i,a),ve[n]!=null&&oe(ye.get(ve[n]),o,c+I(ge/2),pe,dt(0,u-ge),i,a)):oe(Ee,o,c+I(ge/2),pe,dt(0,u-ge),i,a),se(e,t,n,o-ge/2,c,pe+ge,u)}}return ge>0?Te.stroke=_e?xe:Ee:_e||(Te._fill=m.width==0?m._fill:m._stroke??m._fill,Te.width=0),Te.fill=_e?ye:Ee,Te})}function ci(e,t){let n=P(t?.alignGaps,0);return(t,r,i,a)=>Fr(t,r,(o,s,c,l,u,d,f,p,m,h,g)=>{[i,a]=N(c,i,a);let _=o.pxRound,v=e=>_(d(e,l,h,p)),y=e=>_(f(e,u,g,m)),b,x,S;l.ori==0?(b=Wr,S=Kr,x=Qr):(b=Gr,S=qr,x=$r);let C=l.dir*(l.ori==0?1:-1),w=v(s[C==1?i:a]),T=w,E=[],ee=[];for(let e=C==1?i:a;e>=i&&e<=a;e+=C)if(c[e]!=null){let t=s[e],n=v(t);E.push(T=n),ee.push(y(c[e]))}let te={stroke:e(E,ee,b,S,x,_),fill:null,clip:null,band:null,gaps:null,flags:Nr},ne=te.stroke,[re,ie]=Ir(t,r);if(o.fill!=null||re!=0){let e=te.fill=new Path2D(ne),n=y(o.fillTo(t,r,o.min,o.max,re));S(e,T,n),S(e,w,n)}if(!o.spanGaps){let e=[];e.push(...Vr(s,c,i,a,C,v,n)),te.gaps=e=o.gaps(t,r,i,a,e),te.clip=zr(e,l.ori,p,m,h,g)}return ie!=0&&(te.band=ie==2?[Rr(t,r,i,a,ne,-1),Rr(t,r,i,a,ne,1)]:Rr(t,r,i,a,ne,ie)),te})}function li(e){return ci(ui,e)}function ui(e,t,n,r,i,a){let o=e.length;if(o<2)return null;let s=new Path2D;if(n(s,e[0],t[0]),o==2)r(s,e[1],t[1]);else{let n=Array(o),r=Array(o-1),a=Array(o-1),c=Array(o-1);for(let n=0;n<o-1;n++)a[n]=t[n+1]-t[n],c[n]=e[n+1]-e[n],r[n]=a[n]/c[n];n[0]=r[0];for(let e=1;e<o-1;e++)r[e]===0||r[e-1]===0||r[e-1]>0!=r[e]>0?n[e]=0:(n[e]=3*(c[e-1]+c[e])/((2*c[e]+c[e-1])/r[e-1]+(c[e]+2*c[e-1])/r[e]),isFinite(n[e])||(n[e]=0));n[o-1]=r[o-2];for(let r=0;r<o-1;r++)i(s,e[r]+c[r]/3,t[r]+n[r]*c[r]/3,e[r+1]-c[r]/3,t[r+1]-n[r+1]*c[r]/3,e[r+1],t[r+1])}return s}var di=new Set;function fi(){for(let e of di)e.syncRect(!0)}Ee&&(Ve(Se,Oe,fi),Ve(Ce,Oe,fi,!0),Ve(we,Oe,()=>{Oi.pxRatio=k}));var pi=ii(),mi=ei();function hi(e,t,n,r){return(r?[e[0],e[1]].concat(e.slice(2)):[e[0]].concat(e.slice(1))).map((e,r)=>_i(e,r,t,n))}function gi(e,t){return e.map((e,n)=>n==0?{}:B({},t,e))}function _i(e,t,n,r){return B({},t==0?n:r,e)}function vi(e,t,n){return t==null?Lt:[t,n]}var yi=vi;function bi(e,t,n){return t==null?Lt:tt(t,n,Ze,!0)}function xi(e,t,n,r){return t==null?Lt:Ye(t,n,e.scales[r].log,!1)}var Si=xi;function Ci(e,t,n,r){return t==null?Lt:Xe(t,n,e.scales[r].log,!1)}var wi=Ci;function Ti(e,t,n,r,i){let a=dt(vt(e),vt(t)),o=t-e,s=Ue(i/r*o,n);do{let e=n[s],t=r*e/o;if(t>=i&&a+(e<5?Mt.get(e):0)<=17)return[e,t]}while(++s<n.length);return[0,0]}function Ei(e){let t,n;return e=e.replace(/(\d+)px/,(e,r)=>(t=ct((n=+r)*k))+`px`),[e,t,n]}function Di(e){e.show&&[e.font,e.labelFont].forEach(e=>{let t=z(e[2]*k,1);e[0]=e[0].replace(/[0-9.]+px/,t+`px`),e[1]=t})}function Oi(e,t,n){let r={mode:P(e.mode,1)},i=r.mode;function a(e,t,n,r){let i=t.valToPct(e);return r+n*(t.dir==-1?1-i:i)}function o(e,t,n,r){let i=t.valToPct(e);return r+n*(t.dir==-1?i:1-i)}function s(e,t,n,r){return t.ori==0?a(e,t,n,r):o(e,t,n,r)}r.valToPosH=a,r.valToPosV=o;let c=!1;r.status=0;let l=r.root=Ne(h);if(e.id!=null&&(l.id=e.id),Ae(l,e.class),e.title){let t=Ne(v,l);t.textContent=e.title}let u=Me(`canvas`),d=r.ctx=u.getContext(`2d`),f=Ne(y,l);Ve(`click`,f,e=>{e.target===m&&(K!=Li||q!=Ri)&&Hi.click(r,e)},!0);let p=r.under=Ne(b,f);f.appendChild(u);let m=r.over=Ne(x,f);e=Kt(e);let me=+P(e.pxAlign,1),Se=Hr(me);(e.plugins||[]).forEach(t=>{t.opts&&(e=t.opts(r,e)||e)});let Ce=e.ms||.001,D=r.series=i==1?hi(e.series||[],cr,Dr,!1):gi(e.series||[null],Er),Ee=r.axes=hi(e.axes||[],ar,xr,!0),O=r.scales={},ke=r.bands=e.bands||[];ke.forEach(e=>{e.fill=R(e.fill||null),e.dir=P(e.dir,-1)});let A=i==2?D[1].facets[0].scale:D[0].scale,Pe={axes:ai,series:Jr},Ie=(e.drawOrder||[`axes`,`series`]).map(e=>Pe[e]);function Re(e){let t=e.distr==3?t=>mt(t>0?t:e.clamp(r,t,e.min,e.max,e.key)):e.distr==4?t=>_t(t,e.asinh):e.distr==100?t=>e.fwd(t):e=>e;return n=>{let r=t(n),{_min:i,_max:a}=e,o=a-i;return(r-i)/o}}function Be(t){let n=O[t];if(n==null){let r=(e.scales||Ft)[t]||Ft;if(r.from!=null){Be(r.from);let e=B({},O[r.from],r,{key:t});e.valToPct=Re(e),O[t]=e}else{n=O[t]=B({},t==A?kr:Ar,r),n.key=t;let e=n.time,a=n.range,o=Rt(a);if((t!=A||i==2&&!e)&&(o&&(a[0]==null||a[1]==null)&&(a={min:a[0]==null?Qe:{mode:1,hard:a[0],soft:a[0]},max:a[1]==null?Qe:{mode:1,hard:a[1],soft:a[1]}},o=!1),!o&&Ht(a))){let e=a;a=(t,n,r)=>n==null?Lt:tt(n,r,e)}n.range=R(a||(e?yi:t==A?n.distr==3?Si:n.distr==4?wi:vi:n.distr==3?xi:n.distr==4?Ci:bi)),n.auto=R(!o&&n.auto),n.clamp=R(n.clamp||Or),n._min=n._max=null,n.valToPct=Re(n)}}}Be(`x`),Be(`y`),i==1&&D.forEach(e=>{Be(e.scale)}),Ee.forEach(e=>{Be(e.scale)});for(let t in e.scales)Be(t);let M=O[A],We=M.distr,Ge,Ke;M.ori==0?(Ae(l,g),Ge=a,Ke=o):(Ae(l,_),Ge=o,Ke=a);let N={};for(let e in O){let t=O[e];(t.min!=null||t.max!=null)&&(N[e]={min:t.min,max:t.max},t.min=t.max=null)}let qe=e.tzDate||(e=>new Date(ct(e/Ce))),$e=e.fmtDate||ln,et=Ce==1?jn(qe):Pn(qe),rt=In(qe,Fn(Ce==1?An:Nn,$e)),it=Vn(qe,zn(Bn,$e)),at=[],F=r.legend=B({},Wn,e.legend),I=r.cursor=B({},$n,{drag:{y:i==2}},e.cursor),pt=F.show,ht=I.show,vt=F.markers;F.idxs=at,vt.width=R(vt.width),vt.dash=R(vt.dash),vt.stroke=R(vt.stroke),vt.fill=R(vt.fill);let xt,St,Dt,Ot=[],At=[],jt,Pt=!1,zt={};if(F.live){let e=D[1]?D[1].values:null;Pt=e!=null,jt=Pt?e(r,1,0):{_:0};for(let e in jt)zt[e]=Te}if(pt){if(xt=Me(`table`,te,l),Dt=Me(`tbody`,null,xt),F.mount(r,xt),Pt){St=Me(`thead`,null,xt,Dt);let e=Me(`tr`,null,St);for(var Wt in Me(`th`,null,e),jt)Me(`th`,oe,e).textContent=Wt}else Ae(xt,re),F.live&&Ae(xt,ne)}let Gt={show:!0},qt={show:!1};function Jt(e,t){if(t==0&&(Pt||!F.live||i==2))return Lt;let n=[],a=Me(`tr`,ie,Dt,Dt.childNodes[t]);Ae(a,e.class),e.show||Ae(a,C);let o=Me(`th`,null,a);if(vt.show){let e=Ne(ae,o);if(t>0){let n=vt.width(r,t);n&&(e.style.border=n+`px `+vt.dash(r,t)+` `+vt.stroke(r,t)),e.style.background=vt.fill(r,t)}}let s=Ne(oe,o);for(var c in e.label instanceof HTMLElement?s.appendChild(e.label):s.textContent=e.label,t>0&&(vt.show||(s.style.color=e.width>0?vt.stroke(r,t):vt.fill(r,t)),Xt(`click`,o,t=>{if(I._lock)return;Dn(t);let n=D.indexOf(e);if((t.ctrlKey||t.metaKey)!=F.isolate){let e=D.some((e,t)=>t>0&&t!=n&&e.show);D.forEach((t,r)=>{r>0&&Ji(r,e?r==n?Gt:qt:Gt,!0,$.setSeries)})}else Ji(n,{show:!e.show},!0,$.setSeries)},!1),Rn&&Xt(ye,o,t=>{I._lock||(Dn(t),Ji(D.indexOf(e),na,!0,$.setSeries))},!1)),jt){let e=Me(`td`,se,a);e.textContent=`--`,n.push(e)}return[a,n]}let Yt=new Map;function Xt(e,t,n,i=!0){let a=Yt.get(t)||{},o=I.bind[e](r,t,n,i);o&&(Ve(e,t,a[e]=o),Yt.set(t,a))}function Zt(e,t,n){let r=Yt.get(t)||{};for(let n in r)(e==null||n==e)&&(He(n,t,r[n]),delete r[n]);e??Yt.delete(t)}let $t=0,en=0,V=0,H=0,tn=0,nn=0,rn=tn,an=nn,on=V,sn=H,cn=0,un=0,dn=0,fn=0;r.bbox={};let pn=!1,mn=!1,hn=!1,vn=!1,yn=!1,bn=!1;function xn(e,t,n){(n||e!=r.width||t!=r.height)&&Sn(e,t),oi(!1),hn=!0,mn=!0,fi()}function Sn(e,t){r.width=$t=V=e,r.height=en=H=t,tn=nn=0,Tn(),En();let n=r.bbox;cn=n.left=kt(tn*k,.5),un=n.top=kt(nn*k,.5),dn=n.width=kt(V*k,.5),fn=n.height=kt(H*k,.5)}function Cn(){let e=!1,t=0;for(;!e;){t++;let n=ri(t),i=ii(t);e=t==3||n&&i,e||(Sn(r.width,r.height),mn=!0)}}function wn({width:e,height:t}){xn(e,t)}r.setSize=wn;function Tn(){let e=!1,t=!1,n=!1,r=!1;Ee.forEach((i,a)=>{if(i.show&&i._show){let{side:a,_size:o}=i,s=a%2,c=o+(i.label==null?0:i.labelSize);c>0&&(s?(V-=c,a==3?(tn+=c,r=!0):n=!0):(H-=c,a==0?(nn+=c,e=!0):t=!0))}}),Zn[0]=e,Zn[1]=n,Zn[2]=t,Zn[3]=r,V-=nr[1]+nr[3],tn+=nr[3],H-=nr[2]+nr[0],nn+=nr[0]}function En(){let e=tn+V,t=nn+H,n=tn,r=nn;function i(i,a){switch(i){case 1:return e+=a,e-a;case 2:return t+=a,t-a;case 3:return n-=a,n+a;case 0:return r-=a,r+a}}Ee.forEach((e,t)=>{if(e.show&&e._show){let t=e.side;e._pos=i(t,e._size),e.label!=null&&(e._lpos=i(t,e.labelSize))}})}if(I.dataIdx==null){let e=I.hover,n=e.skip=new Set(e.skip??[]);n.add(void 0);let r=e.prox=R(e.prox),i=e.bias??=0;I.dataIdx=(e,a,o,s)=>{if(a==0)return o;let c=o,l=r(e,a,o,s)??L,u=l>=0&&l<L,d=M.ori==0?V:H,f=I.left,p=t[0],m=t[a];if(n.has(m[o])){c=null;let e=null,t=null,r;if(i==0||i==-1)for(r=o;e==null&&r-->0;)n.has(m[r])||(e=r);if(i==0||i==1)for(r=o;t==null&&r++<m.length;)n.has(m[r])||(t=r);if(e!=null||t!=null){if(u){let n=e==null?-1/0:Ge(p[e],M,d,0),r=t==null?1/0:Ge(p[t],M,d,0),i=f-n,a=r-f;i<=a?i<=l&&(c=e):a<=l&&(c=t)}else c=t==null?e:e==null?t:o-e<=t-o?e:t}}else u&&st(f-Ge(p[o],M,d,0))>l&&(c=null);return c}}let Dn=e=>{I.event=e};I.idxs=at,I._lock=!1;let U=I.points;U.show=R(U.show),U.size=R(U.size),U.stroke=R(U.stroke),U.width=R(U.width),U.fill=R(U.fill);let On=r.focus=B({},e.focus||{alpha:.3},I.focus),Rn=On.prox>=0,Hn=Rn&&U.one,Un=[],Gn=[],Kn=[];function qn(e,t){let n=U.show(r,t);if(n instanceof HTMLElement)return Ae(n,ee),Ae(n,e.class),Fe(n,-10,-10,V,H),m.insertBefore(n,Un[t]),n}function Jn(e,t){if(i==1||t>0){let t=i==1&&O[e.scale].time,n=e.value;e.value=t?Vt(n)?Vn(qe,zn(n,$e)):n||it:n||br,e.label=e.label||(t?sr:or)}if(Hn||t>0){e.width=e.width==null?1:e.width,e.paths=e.paths||pi||wt,e.fillTo=R(e.fillTo||Lr),e.pxAlign=+P(e.pxAlign,me),e.pxRound=Hr(e.pxAlign),e.stroke=R(e.stroke||null),e.fill=R(e.fill||null),e._stroke=e._fill=e._paths=e._focus=null;let t=Sr(dt(1,e.width),1),n=e.points=B({},{size:t,width:dt(1,t*.2),stroke:e.stroke,space:t*2,paths:mi,_stroke:null,_fill:null},e.points);n.show=R(n.show),n.filter=R(n.filter),n.fill=R(n.fill),n.stroke=R(n.stroke),n.paths=R(n.paths),n.pxAlign=e.pxAlign}if(pt){let n=Jt(e,t);Ot.splice(t,0,n[0]),At.splice(t,0,n[1]),F.values.push(null)}if(ht){at.splice(t,0,null);let n=null;Hn?t==0&&(n=qn(e,t)):t>0&&(n=qn(e,t)),Un.splice(t,0,n),Gn.splice(t,0,0),Kn.splice(t,0,0)}Q(`addSeries`,t)}function Yn(e,t){t??=D.length,e=i==1?_i(e,t,cr,Dr):_i(e,t,{},Er),D.splice(t,0,e),Jn(D[t],t)}r.addSeries=Yn;function Xn(e){if(D.splice(e,1),pt){F.values.splice(e,1),At.splice(e,1);let t=Ot.splice(e,1)[0];Zt(null,t.firstChild),t.remove()}ht&&(at.splice(e,1),Un.splice(e,1)[0].remove(),Gn.splice(e,1),Kn.splice(e,1)),Q(`delSeries`,e)}r.delSeries=Xn;let Zn=[!1,!1,!1,!1];function Qn(e,t){if(e._show=e.show,e.show){let n=e.side%2,i=O[e.scale];i??=(e.scale=n?D[1].scale:A,O[e.scale]);let a=i.time;e.size=R(e.size),e.space=R(e.space),e.rotate=R(e.rotate),Rt(e.incrs)&&e.incrs.forEach(e=>{!Mt.has(e)&&Mt.set(e,Nt(e))}),e.incrs=R(e.incrs||(i.distr==2?gn:a?Ce==1?kn:Mn:_n)),e.splits=R(e.splits||(a&&i.distr==1?et:i.distr==3?dr:i.distr==4?fr:ur)),e.stroke=R(e.stroke),e.grid.stroke=R(e.grid.stroke),e.ticks.stroke=R(e.ticks.stroke),e.border.stroke=R(e.border.stroke);let o=e.values;e.values=Rt(o)&&!Rt(o[0])?R(o):a?Rt(o)?In(qe,Fn(o,$e)):Vt(o)?Ln(qe,o):o||rt:o||lr,e.filter=R(e.filter||(i.distr>=3&&i.log==10?vr:i.distr==3&&i.log==2?yr:Ct)),e.font=Ei(e.font),e.labelFont=Ei(e.labelFont),e._size=e.size(r,null,t,0),e._space=e._rotate=e._incrs=e._found=e._splits=e._values=null,e._size>0&&(Zn[t]=!0,e._el=Ne(S,f))}}function er(e,t,n,r){let[i,a,o,s]=n,c=t%2,l=0;return c==0&&(s||a)&&(l=t==0&&!i||t==2&&!o?ct(ar.size/3):0),c==1&&(i||o)&&(l=t==1&&!a||t==3&&!s?ct(xr.size/2):0),l}let tr=r.padding=(e.padding||[er,er,er,er]).map(e=>R(P(e,er))),nr=r._padding=tr.map((e,t)=>e(r,t,Zn,0)),rr,W=null,G=null,ir=i==1?D[0].idxs:null,pr=null,mr=!1;function hr(e,n){if(t=e??[],r.data=r._data=t,i==2){rr=0;for(let e=1;e<D.length;e++)rr+=t[e][0].length}else{t.length==0&&(r.data=r._data=t=[[]]),pr=t[0],rr=pr.length;let e=t;if(We==2){e=t.slice();let n=e[0]=Array(rr);for(let e=0;e<rr;e++)n[e]=e}r._data=t=e}if(oi(!0),Q(`setData`),We==2&&(hn=!0),n!==!1){let e=M;e.auto(r,mr)?gr():qi(A,e.min,e.max),vn||=I.left>=0,bn=!0,fi()}}r.setData=hr;function gr(){mr=!0;let e,n;i==1&&(rr>0?(W=ir[0]=0,G=ir[1]=rr-1,e=t[0][W],n=t[0][G],We==2?(e=W,n=G):e==n&&(We==3?[e,n]=Ye(e,e,M.log,!1):We==4?[e,n]=Xe(e,e,M.log,!1):M.time?n=e+ct(86400/Ce):[e,n]=tt(e,n,Ze,!0))):(W=ir[0]=e=null,G=ir[1]=n=null)),qi(A,e,n)}let _r,Cr,wr,Tr,jr,Fr,Ir,Rr,zr,Br;function Vr(e,t,n,r,i,a){e??=he,n??=It,r??=`butt`,i??=he,a??=`round`,e!=_r&&(d.strokeStyle=_r=e),i!=Cr&&(d.fillStyle=Cr=i),t!=wr&&(d.lineWidth=wr=t),a!=jr&&(d.lineJoin=jr=a),r!=Fr&&(d.lineCap=Fr=r),n!=Tr&&d.setLineDash(Tr=n)}function Ur(e,t,n,r){t!=Cr&&(d.fillStyle=Cr=t),e!=Ir&&(d.font=Ir=e),n!=Rr&&(d.textAlign=Rr=n),r!=zr&&(d.textBaseline=zr=r)}function Wr(e,t,n,i,a=0){if(i.length>0&&e.auto(r,mr)&&(t==null||t.min==null)){let t=P(W,0),r=P(G,i.length-1),o=n.min==null?Je(i,t,r,a,e.distr==3):[n.min,n.max];e.min=ut(e.min,n.min=o[0]),e.max=dt(e.max,n.max=o[1])}}let Gr={min:null,max:null};function Kr(){for(let e in O){let t=O[e];N[e]==null&&(t.min==null||N[A]!=null&&t.auto(r,mr))&&(N[e]=Gr)}for(let e in O){let t=O[e];N[e]==null&&t.from!=null&&N[t.from]!=null&&(N[e]=Gr)}N[A]!=null&&oi(!0);let e={};for(let t in N){let n=N[t];if(n!=null){let a=e[t]=Kt(O[t],Ut);if(n.min!=null)B(a,n);else if(t!=A||i==2){if(rr==0&&a.from==null){let e=a.range(r,null,null,t);a.min=e[0],a.max=e[1]}else a.min=L,a.max=-1/0}}}if(rr>0){D.forEach((n,a)=>{if(i==1){let i=n.scale,o=N[i];if(o==null)return;let s=e[i];if(a==0){let e=s.range(r,s.min,s.max,i);s.min=e[0],s.max=e[1],W=Ue(s.min,t[0]),G=Ue(s.max,t[0]),G-W>1&&(t[0][W]<s.min&&W++,t[0][G]>s.max&&G--),n.min=pr[W],n.max=pr[G]}else n.show&&n.auto&&Wr(s,o,n,t[a],n.sorted);n.idxs[0]=W,n.idxs[1]=G}else if(a>0&&n.show&&n.auto){let[r,i]=n.facets,o=r.scale,s=i.scale,[c,l]=t[a],u=e[o],d=e[s];u!=null&&Wr(u,N[o],r,c,r.sorted),d!=null&&Wr(d,N[s],i,l,i.sorted),n.min=i.min,n.max=i.max}});for(let t in e){let n=e[t],i=N[t];if(n.from==null&&(i==null||i.min==null)){let e=n.range(r,n.min==L?null:n.min,n.max==-1/0?null:n.max,t);n.min=e[0],n.max=e[1]}}}for(let t in e){let n=e[t];if(n.from!=null){let i=e[n.from];if(i.min==null)n.min=n.max=null;else{let e=n.range(r,i.min,i.max,t);n.min=e[0],n.max=e[1]}}}let n={},a=!1;for(let t in e){let r=e[t],i=O[t];if(i.min!=r.min||i.max!=r.max){i.min=r.min,i.max=r.max;let e=i.distr;i._min=e==3?mt(i.min):e==4?_t(i.min,i.asinh):e==100?i.fwd(i.min):i.min,i._max=e==3?mt(i.max):e==4?_t(i.max,i.asinh):e==100?i.fwd(i.max):i.max,n[t]=a=!0}}if(a){D.forEach((e,t)=>{i==2?t>0&&n.y&&(e._paths=null):n[e.scale]&&(e._paths=null)});for(let e in n)hn=!0,Q(`setScale`,e);ht&&I.left>=0&&(vn=bn=!0)}for(let e in N)N[e]=null}function qr(e){let t=yt(W-1,0,rr-1),n=yt(G+1,0,rr-1);for(;e[t]==null&&t>0;)t--;for(;e[n]==null&&n<rr-1;)n++;return[t,n]}function Jr(){if(rr>0){let e=D.some(e=>e._focus)&&Br!=On.alpha;e&&(d.globalAlpha=Br=On.alpha),D.forEach((e,n)=>{if(n>0&&e.show&&(Yr(n,!1),Yr(n,!0),e._paths==null)){let a=Br;Br!=e.alpha&&(d.globalAlpha=Br=e.alpha);let o=i==2?[0,t[n][0].length-1]:qr(t[n]);e._paths=e.paths(r,n,o[0],o[1]),Br!=a&&(d.globalAlpha=Br=a)}}),D.forEach((e,t)=>{if(t>0&&e.show){let n=Br;Br!=e.alpha&&(d.globalAlpha=Br=e.alpha),e._paths!=null&&Xr(t,!1);{let n=e._paths==null?null:e._paths.gaps,i=e.points.show(r,t,W,G,n),a=e.points.filter(r,t,i,n);(i||a)&&(e.points._paths=e.points.paths(r,t,W,G,a),Xr(t,!0))}Br!=n&&(d.globalAlpha=Br=n),Q(`drawSeries`,t)}}),e&&(d.globalAlpha=Br=1)}}function Yr(e,t){let n=t?D[e].points:D[e];n._stroke=n.stroke(r,e),n._fill=n.fill(r,e)}function Xr(e,t){let n=t?D[e].points:D[e],{stroke:r,fill:i,clip:a,flags:o,_stroke:s=n._stroke,_fill:c=n._fill,_width:l=n.width}=n._paths;l=z(l*k,3);let u=null,f=l%2/2;t&&c==null&&(c=l>0?`#fff`:s);let p=n.pxAlign==1&&f>0;if(p&&d.translate(f,f),!t){let e=cn-l/2,t=un-l/2,n=dn+l,r=fn+l;u=new Path2D,u.rect(e,t,n,r)}t?Qr(s,l,n.dash,n.cap,c,r,i,o,a):Zr(e,s,l,n.dash,n.cap,c,r,i,o,u,a),p&&d.translate(-f,-f)}function Zr(e,n,i,a,o,s,c,l,u,d,f){let p=!1;u!=0&&ke.forEach((m,h)=>{if(m.series[0]==e){let e=D[m.series[1]],g=t[m.series[1]],_=(e._paths||Ft).band;Rt(_)&&(_=m.dir==1?_[0]:_[1]);let v,y=null;e.show&&_&&nt(g,W,G)?(y=m.fill(r,h)||s,v=e._paths.clip):_=null,Qr(n,i,a,o,y,c,l,u,d,f,v,_),p=!0}}),p||Qr(n,i,a,o,s,c,l,u,d,f)}function Qr(e,t,n,r,i,a,o,s,c,l,u,f){Vr(e,t,n,r,i),(c||l||f)&&(d.save(),c&&d.clip(c),l&&d.clip(l)),f?(s&3)==3?(d.clip(f),u&&d.clip(u),ei(i,o),$r(e,a,t)):s&Pr?(ei(i,o),d.clip(f),$r(e,a,t)):s&Nr&&(d.save(),d.clip(f),u&&d.clip(u),ei(i,o),d.restore(),$r(e,a,t)):(ei(i,o),$r(e,a,t)),(c||l||f)&&d.restore()}function $r(e,t,n){n>0&&(t instanceof Map?t.forEach((e,t)=>{d.strokeStyle=_r=t,d.stroke(e)}):t!=null&&e&&d.stroke(t))}function ei(e,t){t instanceof Map?t.forEach((e,t)=>{d.fillStyle=Cr=t,d.fill(e)}):t!=null&&e&&d.fill(t)}function ti(e,t,n,i){let a=Ee[e],o;if(i<=0)o=[0,0];else{let s=a._space=a.space(r,e,t,n,i);o=Ti(t,n,a._incrs=a.incrs(r,e,t,n,i,s),i,s)}return a._found=o}function ni(e,t,n,r,i,a,o,s,c,l){let u=o%2/2;me==1&&d.translate(u,u),Vr(s,o,c,l,s),d.beginPath();let f,p,m,h,g=i+(r==0||r==3?-a:a);n==0?(p=i,h=g):(f=i,m=g);for(let r=0;r<e.length;r++)t[r]!=null&&(n==0?f=m=e[r]:p=h=e[r],d.moveTo(f,p),d.lineTo(m,h));d.stroke(),me==1&&d.translate(-u,-u)}function ri(e){let t=!0;return Ee.forEach((n,i)=>{if(!n.show)return;let a=O[n.scale];if(a.min==null){n._show&&(t=!1,n._show=!1,oi(!1));return}n._show||(t=!1,n._show=!0,oi(!1));let o=n.side,s=o%2,{min:c,max:l}=a,[u,d]=ti(i,c,l,s==0?V:H);if(d==0)return;let f=a.distr==2,p=n._splits=n.splits(r,i,c,l,u,d,f),m=a.distr==2?p.map(e=>pr[e]):p,h=a.distr==2?pr[p[1]]-pr[p[0]]:u,g=n._values=n.values(r,n.filter(r,m,i,d,h),i,d,h);n._rotate=o==2?n.rotate(r,g,i,d):0;let _=n._size;n._size=lt(n.size(r,g,i,e)),_!=null&&n._size!=_&&(t=!1)}),t}function ii(e){let t=!0;return tr.forEach((n,i)=>{let a=n(r,i,Zn,e);a!=nr[i]&&(t=!1),nr[i]=a}),t}function ai(){for(let e=0;e<Ee.length;e++){let t=Ee[e];if(!t.show||!t._show)continue;let n=t.side,i=n%2,a,o,c=t.stroke(r,e),l=n==0||n==3?-1:1,[u,f]=t._found;if(t.label!=null){let s=t.labelGap*l,p=ct((t._lpos+s)*k);Ur(t.labelFont[0],c,`center`,n==2?ue:de),d.save(),i==1?(a=o=0,d.translate(p,ct(un+fn/2)),d.rotate((n==3?-ot:ot)/2)):(a=ct(cn+dn/2),o=p);let m=bt(t.label)?t.label(r,e,u,f):t.label;d.fillText(m,a,o),d.restore()}if(f==0)continue;let p=O[t.scale],m=i==0?dn:fn,h=i==0?cn:un,g=t._splits,_=p.distr==2?g.map(e=>pr[e]):g,v=p.distr==2?pr[g[1]]-pr[g[0]]:u,y=t.ticks,b=t.border,x=y.show?y.size:0,S=ct(x*k),C=ct((t.alignTo==2?t._size-x-t.gap:t.gap)*k),w=t._rotate*-ot/180,T=Se(t._pos*k),E=T+(S+C)*l;o=i==0?E:0,a=i==1?E:0;let ee=t.font[0];Ur(ee,c,t.align==1?fe:t.align==2?pe:w>0?fe:w<0?pe:i==0?`center`:n==3?pe:fe,w||i==1?`middle`:n==2?ue:de);let te=t.font[1]*t.lineGap,ne=g.map(e=>Se(s(e,p,m,h))),re=t._values;for(let e=0;e<re.length;e++){let t=re[e];if(t!=null){i==0?a=ne[e]:o=ne[e],t=``+t;let n=t.indexOf(`
`)==-1?[t]:t.split(/\n/gm);for(let e=0;e<n.length;e++){let t=n[e];w?(d.save(),d.translate(a,o+e*te),d.rotate(w),d.fillText(t,0,0),d.restore()):d.fillText(t,a,o+e*te)}}}y.show&&ni(ne,y.filter(r,_,e,f,v),i,n,T,S,z(y.width*k,3),y.stroke(r,e),y.dash,y.cap);let ie=t.grid;ie.show&&ni(ne,ie.filter(r,_,e,f,v),i,i==0?2:1,i==0?un:cn,i==0?fn:dn,z(ie.width*k,3),ie.stroke(r,e),ie.dash,ie.cap),b.show&&ni([T],[1],+(i==0),i==0?1:2,i==1?un:cn,i==1?fn:dn,z(b.width*k,3),b.stroke(r,e),b.dash,b.cap)}Q(`drawAxes`)}function oi(e){D.forEach((t,n)=>{n>0&&(t._paths=null,e&&(i==1?(t.min=null,t.max=null):t.facets.forEach(e=>{e.min=null,e.max=null})))})}let si=!1,ci=!1,li=[];function ui(){ci=!1;for(let e=0;e<li.length;e++)Q(...li[e]);li.length=0}function fi(){si||=(Qt(ki),!0)}function Oi(e,t=!1){si=!0,ci=t,e(r),ki(),t&&li.length>0&&queueMicrotask(ui)}r.batch=Oi;function ki(){if(pn&&=(Kr(),!1),hn&&=(Cn(),!1),mn){if(j(p,fe,tn),j(p,ue,nn),j(p,ce,V),j(p,le,H),j(m,fe,tn),j(m,ue,nn),j(m,ce,V),j(m,le,H),j(f,ce,$t),j(f,le,en),u.width=ct($t*k),u.height=ct(en*k),Ee.forEach(({_el:e,_show:t,_size:n,_pos:r,side:i})=>{if(e!=null){if(t){let t=i===3||i===0?n:0,a=i%2==1;j(e,a?`left`:`top`,r-t),j(e,a?`width`:`height`,n),j(e,a?`top`:`left`,a?nn:tn),j(e,a?`height`:`width`,a?H:V),je(e,C)}else Ae(e,C)}}),_r=Cr=wr=jr=Fr=Ir=Rr=zr=Tr=null,Br=1,ma(!0),tn!=rn||nn!=an||V!=on||H!=sn){oi(!1);let e=V/on,t=H/sn;if(ht&&!vn&&I.left>=0){I.left*=e,I.top*=t,Ni&&Fe(Ni,ct(I.left),0,V,H),Pi&&Fe(Pi,0,ct(I.top),V,H);for(let n=0;n<Un.length;n++){let r=Un[n];r!=null&&(Gn[n]*=e,Kn[n]*=t,Fe(r,lt(Gn[n]),lt(Kn[n]),V,H))}}if(Y.show&&!yn&&Y.left>=0&&Y.width>0){Y.left*=e,Y.width*=e,Y.top*=t,Y.height*=t;for(let e in _a)j(Wi,e,Y[e])}rn=tn,an=nn,on=V,sn=H}Q(`setSize`),mn=!1}$t>0&&en>0&&(d.clearRect(0,0,u.width,u.height),Q(`drawClear`),Ie.forEach(e=>e()),Q(`draw`)),Y.show&&yn&&(Gi(Y),yn=!1),ht&&vn&&(fa(null,!0,!1),vn=!1),F.show&&F.live&&bn&&(X(),bn=!1),c||(c=!0,r.status=1,Q(`ready`)),mr=!1,si=!1}r.redraw=(e,t)=>{hn=t||!1,e===!1?fi():qi(A,M.min,M.max)};function Ai(e,n){let i=O[e];if(i.from==null){if(rr==0){let t=i.range(r,n.min,n.max,e);n.min=t[0],n.max=t[1]}if(n.min>n.max){let e=n.min;n.min=n.max,n.max=e}if(rr>1&&n.min!=null&&n.max!=null&&n.max-n.min<1e-16)return;e==A&&i.distr==2&&rr>0&&(n.min=Ue(n.min,t[0]),n.max=Ue(n.max,t[0]),n.min==n.max&&n.max++),N[e]=n,pn=!0,fi()}}r.setScale=Ai;let ji,Mi,Ni,Pi,Fi,Ii,Li,Ri,zi,Bi,K,q,Vi=!1,Hi=I.drag,Ui=Hi.x,J=Hi.y;ht&&(I.x&&(ji=Ne(T,m)),I.y&&(Mi=Ne(E,m)),M.ori==0?(Ni=ji,Pi=Mi):(Ni=Mi,Pi=ji),K=I.left,q=I.top);let Y=r.select=B({show:!0,over:!0,left:0,width:0,top:0,height:0},e.select),Wi=Y.show?Ne(w,Y.over?m:p):null;function Gi(e,t){if(Y.show){for(let t in e)Y[t]=e[t],t in _a&&j(Wi,t,e[t]);t!==!1&&Q(`setSelect`)}}r.setSelect=Gi;function Ki(e){if(D[e].show)pt&&je(Ot[e],C);else if(pt&&Ae(Ot[e],C),ht){let t=Hn?Un[0]:Un[e];t!=null&&Fe(t,-10,-10,V,H)}}function qi(e,t,n){Ai(e,{min:t,max:n})}function Ji(e,t,n,a){t.focus!=null&&ra(e),t.show!=null&&D.forEach((n,r)=>{r>0&&(e==r||e==null)&&(n.show=t.show,Ki(r),i==2?(qi(n.facets[0].scale,null,null),qi(n.facets[1].scale,null,null)):qi(n.scale,null,null),fi())}),n!==!1&&Q(`setSeries`,e,t),a&&Ma(`setSeries`,r,e,t)}r.setSeries=Ji;function Yi(e,t){B(ke[e],t)}function Xi(e,t){e.fill=R(e.fill||null),e.dir=P(e.dir,-1),t??=ke.length,ke.splice(t,0,e)}function Zi(e){e==null?ke.length=0:ke.splice(e,1)}r.addBand=Xi,r.setBand=Yi,r.delBand=Zi;function Qi(e,t){D[e].alpha=t,ht&&Un[e]!=null&&(Un[e].style.opacity=t),pt&&Ot[e]&&(Ot[e].style.opacity=t)}let $i,ea,ta,na={focus:!0};function ra(e){if(e!=ta){let t=e==null,n=On.alpha!=1;D.forEach((r,a)=>{if(i==1||a>0){let i=t||a==0||a==e;r._focus=t?null:i,n&&Qi(a,i?1:On.alpha)}}),ta=e,n&&fi()}}pt&&Rn&&Xt(be,xt,e=>{I._lock||(Dn(e),ta!=null&&Ji(null,na,!0,$.setSeries))});function ia(e,t,n){let r=O[t];n&&(e=e/k-(r.ori==1?nn:tn));let i=V;r.ori==1&&(i=H,e=i-e),r.dir==-1&&(e=i-e);let a=r._min,o=r._max,s=e/i,c=a+(o-a)*s,l=r.distr;return l==3?ft(10,c):l==4?gt(c,r.asinh):l==100?r.bwd(c):c}function aa(e,n){return Ue(ia(e,A,n),t[0],W,G)}r.valToIdx=e=>Ue(e,t[0]),r.posToIdx=aa,r.posToVal=ia,r.valToPos=(e,t,n)=>O[t].ori==0?a(e,O[t],n?dn:V,n?cn:0):o(e,O[t],n?fn:H,n?un:0),r.setCursor=(e,t,n)=>{K=e.left,q=e.top,fa(null,t,n)};function oa(e,t){j(Wi,fe,Y.left=e),j(Wi,ce,Y.width=t)}function sa(e,t){j(Wi,ue,Y.top=e),j(Wi,le,Y.height=t)}let ca=M.ori==0?oa:sa,la=M.ori==1?oa:sa;function ua(){if(pt&&F.live)for(let e=+(i==2);e<D.length;e++){if(e==0&&Pt)continue;let t=F.values[e],n=0;for(let r in t)At[e][n++].firstChild.nodeValue=t[r]}}function X(e,t){if(e!=null&&(e.idxs?e.idxs.forEach((e,t)=>{at[t]=e}):Bt(e.idx)||at.fill(e.idx),F.idx=at[0]),pt&&F.live){for(let e=0;e<D.length;e++)(e>0||i==1&&!Pt)&&da(e,at[e]);ua()}bn=!1,t!==!1&&Q(`setLegend`)}r.setLegend=X;function da(e,n){let i=D[e],a=e==0&&We==2?pr:t[e],o;Pt?o=i.values(r,e,n)??zt:(o=i.value(r,n==null?null:a[n],e,n),o=o==null?zt:{_:o}),F.values[e]=o}function fa(e,n,a){zi=K,Bi=q,[K,q]=I.move(r,K,q),I.left=K,I.top=q,ht&&(Ni&&Fe(Ni,ct(K),0,V,H),Pi&&Fe(Pi,0,ct(q),V,H));let o,s=W>G;$i=L,ea=null;let c=M.ori==0?V:H,l=M.ori==1?V:H;if(K<0||rr==0||s){o=I.idx=null;for(let e=0;e<D.length;e++){let t=Un[e];t!=null&&Fe(t,-10,-10,V,H)}Rn&&Ji(null,na,!0,e==null&&$.setSeries),F.live&&(at.fill(o),bn=!0)}else{let e,n,a;i==1&&(e=M.ori==0?K:q,n=ia(e,A),o=I.idx=Ue(n,t[0],W,G),a=Ge(t[0][o],M,c,0));let s=-10,u=-10,d=0,f=0,p=!0,m=``,h=``;for(let e=+(i==2);e<D.length;e++){let g=D[e],_=at[e],v=_==null?null:i==1?t[e][_]:t[e][1][_],y=I.dataIdx(r,e,o,n),b=y==null?null:i==1?t[e][y]:t[e][1][y];if(bn=bn||b!=v||y!=_,at[e]=y,e>0&&g.show){let n=y==null?-10:y==o?a:Ge(i==1?t[0][y]:t[e][0][y],M,c,0),_=b==null?-10:Ke(b,i==1?O[g.scale]:O[g.facets[1].scale],l,0);if(Rn&&b!=null){let t=M.ori==1?K:q,n=st(On.dist(r,e,y,_,t));if(n<$i){let r=On.bias;if(r!=0){let i=ia(t,g.scale),a=b>=0?1:-1,o=i>=0?1:-1;o==a&&(o==1?r==1?b>=i:b<=i:r==1?b<=i:b>=i)&&($i=n,ea=e)}else $i=n,ea=e}}if(bn||Hn){let t,i;M.ori==0?(t=n,i=_):(t=_,i=n);let a,o,c,l,g,v,y=!0,b=U.bbox;if(b!=null){y=!1;let t=b(r,e);c=t.left,l=t.top,a=t.width,o=t.height}else c=t,l=i,a=o=U.size(r,e);if(v=U.fill(r,e),g=U.stroke(r,e),Hn)e==ea&&$i<=On.prox&&(s=c,u=l,d=a,f=o,p=y,m=v,h=g);else{let t=Un[e];t!=null&&(Gn[e]=c,Kn[e]=l,ze(t,a,o,y),Le(t,v,g),Fe(t,lt(c),lt(l),V,H))}}}}if(Hn){let e=On.prox;if(bn||(ta==null?$i<=e:$i>e||ea!=ta)){let e=Un[0];e!=null&&(Gn[0]=s,Kn[0]=u,ze(e,d,f,p),Le(e,m,h),Fe(e,lt(s),lt(u),V,H))}}}if(Y.show&&Vi){if(e!=null){let[t,n]=$.scales,[r,i]=$.match,[a,o]=e.cursor.sync.scales,s=e.cursor.drag;if(Ui=s._x,J=s._y,Ui||J){let{left:s,top:u,width:d,height:f}=e.select,p=e.scales[a].ori,m=e.posToVal,h,g,_,v,y,b=t!=null&&r(t,a),x=n!=null&&i(n,o);b&&Ui?(p==0?(h=s,g=d):(h=u,g=f),_=O[t],v=Ge(m(h,a),_,c,0),y=Ge(m(h+g,a),_,c,0),ca(ut(v,y),st(y-v))):ca(0,c),x&&J?(p==1?(h=s,g=d):(h=u,g=f),_=O[n],v=Ke(m(h,o),_,l,0),y=Ke(m(h+g,o),_,l,0),la(ut(v,y),st(y-v))):la(0,l)}else va()}else{let e=st(zi-Fi),t=st(Bi-Ii);if(M.ori==1){let n=e;e=t,t=n}Ui=Hi.x&&e>=Hi.dist,J=Hi.y&&t>=Hi.dist;let n=Hi.uni;n==null?Hi.x&&Hi.y&&(Ui||J)&&(Ui=J=!0):Ui&&J&&(Ui=e>=n,J=t>=n,!Ui&&!J&&(t>e?J=!0:Ui=!0));let r,i;Ui&&(M.ori==0?(r=Li,i=K):(r=Ri,i=q),ca(ut(r,i),st(i-r)),J||la(0,l)),J&&(M.ori==1?(r=Li,i=K):(r=Ri,i=q),la(ut(r,i),st(i-r)),Ui||ca(0,c)),!Ui&&!J&&(ca(0,0),la(0,0))}}if(Hi._x=Ui,Hi._y=J,e==null){if(a){if(Aa!=null){let[e,t]=$.scales;$.values[0]=e==null?null:ia(M.ori==0?K:q,e),$.values[1]=t==null?null:ia(M.ori==1?K:q,t)}Ma(ge,r,K,q,V,H,o)}if(Rn){let e=a&&$.setSeries,t=On.prox;ta==null?$i<=t&&Ji(ea,na,!0,e):$i>t?Ji(null,na,!0,e):ea!=ta&&Ji(ea,na,!0,e)}}bn&&(F.idx=o,X()),n!==!1&&Q(`setCursor`)}let pa=null;Object.defineProperty(r,"rect",{get(){return pa??ma(!1),pa}});function ma(e=!1){e?pa=null:(pa=m.getBoundingClientRect(),Q(`syncRect`,pa))}function ha(e,t,n,r,i,a,o){I._lock||Vi&&e!=null&&e.movementX==0&&e.movementY==0||(ga(e,t,n,r,i,a,o,!1,e!=null),e==null?fa(t,!0,!1):fa(null,!0,!0))}function ga(e,t,n,i,a,o,c,l,u){if(pa??ma(!1),Dn(e),e!=null)n=e.clientX-pa.left,i=e.clientY-pa.top;else{if(n<0||i<0){K=-10,q=-10;return}let[e,r]=$.scales,c=t.cursor.sync,[l,u]=c.values,[d,f]=c.scales,[p,m]=$.match,h=t.axes[0].side%2==1,g=M.ori==0?V:H,_=M.ori==1?V:H,v=h?o:a,y=h?a:o,b=h?i:n,x=h?n:i;if(n=d==null?b/v*g:p(e,d)?s(l,O[e],g,0):-10,i=f==null?x/y*_:m(r,f)?s(u,O[r],_,0):-10,M.ori==1){let e=n;n=i,i=e}}u&&(t==null||t.cursor.event.type==ge)&&((n<=1||n>=V-1)&&(n=kt(n,V)),(i<=1||i>=H-1)&&(i=kt(i,H))),l?(Fi=n,Ii=i,[Li,Ri]=I.move(r,n,i)):(K=n,q=i)}let _a={width:0,height:0,left:0,top:0};function va(){Gi(_a,!1)}let ya,ba,Z,xa;function Sa(e,t,n,i,a,o,s){Vi=!0,Ui=J=Hi._x=Hi._y=!1,ga(e,t,n,i,a,o,s,!0,!1),e!=null&&(Xt(ve,De,Ca,!1),Ma(_e,r,Li,Ri,V,H,null));let{left:c,top:l,width:u,height:d}=Y;ya=c,ba=l,Z=u,xa=d}function Ca(e,t,n,i,a,o,s){Vi=Hi._x=Hi._y=!1,ga(e,t,n,i,a,o,s,!1,!0);let{left:c,top:l,width:u,height:d}=Y,f=u>0||d>0,p=ya!=c||ba!=l||Z!=u||xa!=d;if(f&&p&&Gi(Y),Hi.setScale&&f&&p){let e=c,t=u,n=l,r=d;if(M.ori==1&&(e=l,t=d,n=c,r=u),Ui&&qi(A,ia(e,A),ia(e+t,A)),J)for(let e in O){let t=O[e];e!=A&&t.from==null&&t.min!=L&&qi(e,ia(n+r,e),ia(n,e))}va()}else I.lock&&(I._lock=!I._lock,fa(t,!0,e!=null));e!=null&&(Zt(ve,De),Ma(ve,r,K,q,V,H,null))}function wa(e,t,n,r,i,a,o){if(I._lock)return;Dn(e);let s=Vi;if(Vi){let e=!0,t=!0,n,r;M.ori==0?(n=Ui,r=J):(n=J,r=Ui),n&&r&&(e=K<=10||K>=V-10,t=q<=10||q>=H-10),n&&e&&(K=K<Li?0:V),r&&t&&(q=q<Ri?0:H),fa(null,!0,!0),Vi=!1}K=-10,q=-10,at.fill(null),fa(null,!0,!0),s&&(Vi=s)}function Ta(e,t,n,i,a,o,s){I._lock||(Dn(e),gr(),va(),e!=null&&Ma(xe,r,K,q,V,H,null))}function Ea(){Ee.forEach(Di),xn(r.width,r.height,!0)}Ve(we,Oe,Ea);let Da={};Da.mousedown=Sa,Da.mousemove=ha,Da.mouseup=Ca,Da.dblclick=Ta,Da.setSeries=(e,t,n,i)=>{let a=$.match[2];n=a(r,t,n),n!=-1&&Ji(n,i,!0,!1)},ht&&(Xt(_e,m,Sa),Xt(ge,m,ha),Xt(ye,m,e=>{Dn(e),ma(!1)}),Xt(be,m,wa),Xt(xe,m,Ta),di.add(r),r.syncRect=ma);let Oa=r.hooks=e.hooks||{};function Q(e,t,n){ci?li.push([e,t,n]):e in Oa&&Oa[e].forEach(e=>{e.call(null,r,t,n)})}(e.plugins||[]).forEach(e=>{for(let t in e.hooks)Oa[t]=(Oa[t]||[]).concat(e.hooks[t])});let ka=(e,t,n)=>n,$=B({key:null,setSeries:!1,filters:{pub:Tt,sub:Tt},scales:[A,D[1]?D[1].scale:null],match:[Et,Et,ka],values:[null,null]},I.sync);$.match.length==2&&$.match.push(ka),I.sync=$;let Aa=$.key,ja=Mr(Aa);function Ma(e,t,n,r,i,a,o){$.filters.pub(e,t,n,r,i,a,o)&&ja.pub(e,t,n,r,i,a,o)}ja.sub(r);function Na(e,t,n,r,i,a,o){$.filters.sub(e,t,n,r,i,a,o)&&Da[e](null,t,n,r,i,a,o)}r.pub=Na;function Pa(){ja.unsub(r),di.delete(r),Yt.clear(),He(we,Oe,Ea),l.remove(),xt?.remove(),Q(`destroy`)}r.destroy=Pa;function Fa(){Q(`init`,e,t),hr(t||e.data,!1),N[A]?Ai(A,N[A]):gr(),yn=Y.show&&(Y.width>0||Y.height>0),vn=bn=!0,xn(e.width,e.height)}return D.forEach(Jn),Ee.forEach(Qn),n?n instanceof HTMLElement?(n.appendChild(l),Fa()):n(r,Fa):Fa(),r}Oi.assign=B,Oi.fmtNum=at,Oi.rangeNum=tt,Oi.rangeLog=Ye,Oi.rangeAsinh=Xe,Oi.orient=Fr,Oi.pxRatio=k,Oi.join=Zt,Oi.fmtDate=ln,Oi.tzDate=dn,Oi.sync=Mr;{Oi.addGap=Br,Oi.clipGaps=zr;let e=Oi.paths={points:ei};e.linear=ii,e.stepped=ai,e.bars=si,e.spline=li}var ki=25.4,Ai=`mm`,ji=e=>{Ai=e},Mi=()=>Ai,Ni=()=>Ai===`mm`?`µm`:`thou`,Pi=e=>Ai===`mm`?e:e/ki;function Fi(e){let t=Number(e);return e===`-`||!Number.isFinite(t)?`–`:Ai===`in`?(t/ki).toFixed(3):typeof e==`string`?e:e.toFixed(2)}function Ii(e){let t=(Ai===`mm`?e:e/ki).toFixed(Ai===`mm`?3:4);return Number(t)===0?t.replace(`-`,``):t.replace(`-`,`−`)}var Li=e=>`${Number((Ai===`mm`?e:e/ki).toPrecision(3))} ${Ai}`,Ri=e=>`${Number((e/1e6).toPrecision(3))} MB`,zi=2400,Bi=class{onPick=()=>{};#e;#t=[];#n;constructor(e){this.#n=e,new ResizeObserver(()=>this.#e?.setSize({width:e.clientWidth,height:e.clientHeight})).observe(e)}show(e){if(this.#t=e,this.#e?.destroy(),this.#e=void 0,!e.length)return;let n={stroke:t(`--grid`),width:1},r={stroke:t(`--ink-3`),grid:n,ticks:n,font:`12px system-ui, sans-serif`},i={width:this.#n.clientWidth,height:this.#n.clientHeight,legend:{show:!1},scales:{x:{time:!1}},cursor:{drag:{x:!0,y:!1,setScale:!1},points:{show:!1}},axes:[{...r,size:28,values:(e,t)=>t.map((e,n)=>n===t.length-1?`${e} s`:`${e}`)},{...r,size:52,label:Ni(),labelSize:16,labelFont:`12px system-ui, sans-serif`}],series:[{},...e.map(e=>({label:e.figures.name,stroke:t(`--${e.look}`),width:1,points:{show:!1}}))],hooks:{setSelect:[e=>{let{left:t,width:n}=e.select;n>4&&this.#i(e.posToVal(t,`x`),e.posToVal(t+n,`x`)),e.setSelect({left:0,top:0,width:0,height:0},!1)}]}};this.#e=new Oi(i,this.#a(0,this.#r()),this.#n),this.#e.over.addEventListener(`click`,()=>{let e=this.#e.cursor.left??-1;e>=0&&this.onPick(this.#e.posToVal(e,`x`))}),this.#e.over.addEventListener(`dblclick`,()=>this.#i(0,this.#r()))}tool(e){let t=this.#e;t?.setCursor({left:t.valToPos(e,`x`),top:t.over.clientHeight/2},!1)}#r(){return Math.max(...this.#t.map(({t_s:e})=>e[e.length-1]??0))}#i(e,t){this.#e.setData(this.#a(e,t),!1),this.#e.batch(()=>{this.#e.setScale(`x`,{min:e,max:t})})}#a(e,t){let n=(t-e)/zi||1,r=Array.from({length:2401},(t,r)=>e+r*n);return[r,...this.#t.map(({t_s:t,error_um:i,cutting:a})=>{let o=r.map(()=>null),s=(e,t)=>{Math.abs(t)>Math.abs(o[e]??0)&&(o[e]=t)};for(let r=0;r<t.length;r++){let o=Math.round((t[r]-e)/n);if(!a[r]||o<0||o>zi)continue;let c=Pi(i[r]);if(s(o,c),!a[r+1])continue;let l=Math.min(zi,Math.round((t[r+1]-e)/n));for(let e=o+1;e<l;e++)s(e,c+(Pi(i[r+1])-c)*(e-o)/(l-o))}return o})]}};function K(e){let t=0,n=e=>{t=Math.max(0,e),o(`drop`).hidden=t===0};addEventListener(`dragenter`,e=>{e.preventDefault(),n(t+1)}),addEventListener(`dragleave`,()=>n(t-1)),addEventListener(`dragover`,e=>e.preventDefault()),addEventListener(`drop`,t=>{t.preventDefault(),n(0),e([...t.dataTransfer?.files??[]])})}var q=2**21,Vi=4e3,Hi=class{onChange=()=>{};#e;#t;#n=new Map;#r=0;#i=1;#a=0;#o;constructor(e,t){[this.#e,this.#t]=[e,t],e.addEventListener(`input`,()=>{this.#d(),this.onChange()}),e.addEventListener(`scroll`,()=>{this.#u(),this.#f()}),new ResizeObserver(()=>this.#f()).observe(e)}get value(){return this.#o?.program??this.#e.value}set value(e){let t=e.length>q;this.#o=t?{program:e,starts:Ui(e)}:void 0,this.#e.readOnly=t,this.#e.title=t?`The program is too long to be edited here.`:``,this.#r=this.#a=0,this.#n.clear(),t?this.#l(0):this.#e.value=e,this.#e.scrollTop=0,this.#d()}mark(e){this.#n=new Map([...e].reverse().map(({line:e,severity:t})=>[e,t])),this.#f()}current(e){e!==this.#r&&(this.#r=e,this.#c(e),this.#f())}go({line:e,column:t,length:n}){this.#c(e);let r=this.#e.value.split(`
`,e-this.#a).slice(0,-1).reduce((e,t)=>e+t.length+1,0)+Math.max(0,t-1);this.#e.focus(),this.#e.setSelectionRange(r,r+n),this.#c(e)}get#s(){return parseFloat(getComputedStyle(this.#e).lineHeight)}#c(e){this.#o&&(e<=this.#a||e>this.#a+this.#i)&&this.#l(e-Vi/2);let t=this.#s,n=(e-1-this.#a)*t,{scrollTop:r,clientHeight:i}=this.#e;(n<r||n>r+i-2*t)&&(this.#e.scrollTop=n-i/2)}#l(e){let{program:t,starts:n}=this.#o,r=n.length-1;this.#a=Math.max(0,Math.min(e,r-Vi)),this.#e.value=t.slice(n[this.#a],n[Math.min(r,this.#a+Vi)]),this.#d()}#u(){if(!this.#o)return;let{scrollTop:e,scrollHeight:t,clientHeight:n}=this.#e,r=this.#a;e>0&&e+n<t-1||(this.#l(e>0?r+Vi/2:r-Vi/2),this.#a!==r&&(this.#e.scrollTop=e+(r-this.#a)*this.#s))}#d(){this.#i=Ui(this.#e.value).length-1,this.#f()}#f(){let e=this.#s,{scrollTop:t,clientHeight:n}=this.#e,r=Math.floor(t/e)+1,i=Math.min(this.#i,r+Math.ceil(n/e)),a=[];for(let e=this.#a+r;e<=this.#a+i;e++){let t=document.createElement(`div`),n=this.#n.get(e);t.textContent=String(e),n&&t.classList.add(n),e===this.#r&&t.classList.add(`current`),a.push(t)}this.#t.replaceChildren(...a),this.#t.style.setProperty(`--shift`,`${(r-1)*e-t}px`)}};function Ui(e){let t=1;for(let n=-1;(n=e.indexOf(`
`,n+1))>=0;)t++;let n=new Uint32Array(t+1);for(let r=1;r<t;r++)n[r]=e.indexOf(`
`,n[r-1])+1;return n[t]=e.length,n}var J;function Y(){return J??=Wi(`engine.wasm.gz`),J}async function Wi(e){let t=await fetch(e);if(!t.ok||!t.body)throw Error(`${e} is missing: ${t.status}`);let n=t.body.getReader(),r=await n.read(),i=new ReadableStream({start:e=>r.value?e.enqueue(r.value):e.close(),pull:async e=>{let{done:t,value:r}=await n.read();t?e.close():e.enqueue(r)}}),a=r.value?.[0]===31&&r.value[1]===139?i.pipeThrough(new DecompressionStream(`gzip`)):i;return WebAssembly.compileStreaming(new Response(a,{headers:{"Content-Type":`application/wasm`}}))}var Gi=class extends Error{},Ki=class{#e;#t=new Map;#n=0;async ask(e,t={}){let n=await Y(),r=this.#e??=this.#r(),i=++this.#n;return new Promise((a,o)=>{this.#t.set(i,{resolve:a,reject:o,listener:t}),r.postMessage({id:i,module:n,request:e})})}cancel(){this.#e?.terminate(),this.#e=void 0;let e=[...this.#t.values()];this.#t.clear(),e.forEach(e=>e.reject(new Gi(`cancelled`)))}#r(){let e=new Worker(new URL(new URL(`engine.js`,import.meta.url).href,``+import.meta.url),{type:`module`,name:`engine`});return e.onmessage=({data:e})=>{let t=this.#t.get(e.id);t&&(e.kind===`progress`?t.listener.progress?.(e.stage,e.part):e.kind===`points`?t.listener.points?.(e.points):(this.#t.delete(e.id),e.kind===`done`?t.resolve(e.answer):t.reject(Error(e.reason))))},e.onerror=e=>{this.#t.forEach(t=>t.reject(Error(e.message||`the engine does not start`))),this.#t.clear()},e}},qi;function Ji(e,t,n){qi={stem:e,identified:n};let{axes:r,findings:i,improvements:a,advice:s}=n;o(`log`).textContent=`${t}. Numbers with their intervals of 90 %. Run cuts on this machine.`,o(`axes`).replaceChildren(...r.map(Yi),...[[`What the log is taken for`,i],[`What would be better`,a],[`What to record next`,s]].map(([e,t])=>Xi(e,t))),o(`identified`).hidden=!1}function Yi({name:e,verdict:t,numbers:n}){let r=s(`div`),i=s(`table`),a=s(`tbody`),o=s(`tr`);return o.append(...[`Number`,`Value`,`90 %`].map(e=>Object.assign(s(`th`,e),{scope:`col`}))),i.append(s(`thead`),a),i.tHead.append(o),a.append(...n.map(([e,t,n,r,i])=>{let a=s(`tr`),o=s(`th`,e);return o.scope=`row`,o.append(s(`small`,i)),a.append(o,s(`td`,`${t} ${n}`),s(`td`,r.replace(` to `,` – `))),a})),r.append(s(`h3`,`Axis ${e}`),s(`p`,t.replace(/ um\b/g,` µm`)),i),r}function Xi(e,t){let n=s(`details`),r=s(`ul`);return n.hidden=!t.length,r.append(...t.map(e=>s(`li`,e))),n.append(s(`summary`,e),r),n}function Zi(){o(`machine-file`).addEventListener(`click`,()=>qi&&u(`${qi.stem}.toml`,new Blob([qi.identified.file],{type:`text/plain`}))),o(`identification`).addEventListener(`click`,()=>qi&&u(`${qi.stem}.html`,qi.identified.page))}var Qi=class{play;slider;speed;onMove=()=>{};#e;#t=0;#n;constructor(e,t,n){this.play=e,this.slider=t,this.speed=n,e.addEventListener(`click`,()=>this.#n?this.stop():this.#r()),t.addEventListener(`input`,()=>{this.stop(),this.time(Number(t.value))}),n.addEventListener(`change`,()=>this.#n&&this.#r())}show(e){this.stop(),this.#e=e,this.#t=0;let t=e?e.t_s[e.t_s.length-1]:0;[this.slider.max,this.slider.step,this.slider.value]=[String(t),String(t/2e3||1),`0`],this.play.disabled=this.slider.disabled=this.speed.disabled=!e}time(e){let t=this.#e?.t_s;if(!t)return;let[n,r]=[0,t.length-1];for(;n<r;){let i=n+r>>1;t[i]<e?n=i+1:r=i}this.index(n>0&&e-t[n-1]<t[n]-e?n-1:n)}index(e){this.#e&&(this.#t=e,this.slider.value=String(this.#e.t_s[e]),this.onMove(e))}stop(){this.#n=void 0,this.play.textContent=`Play`}#r(){let e=this.#e?.t_s;if(!e)return;let t=this.#t>=e.length-1?0:e[this.#t],n={at:performance.now(),t_s:t};this.#n=n,this.play.textContent=`Pause`;let r=()=>{if(this.#n!==n)return;let i=t+(performance.now()-n.at)/1e3*Number(this.speed.value);this.time(i),i>=e[e.length-1]?this.stop():requestAnimationFrame(r)};requestAnimationFrame(r)}};function $i(e,t,n){let r=e.length/3,i=new Int16Array(r).fill(-1),a=new Uint32Array(t+1);for(let e=1;e<r;e++)i[e]=n(e),i[e]>=0&&a[i[e]+1]++;for(let e=0;e<t;e++)a[e+1]+=a[e];let o=new Uint32Array(a[t]),s=a.slice();for(let e=1;e<r;e++)i[e]>=0&&(o[s[i[e]]++]=e);return{count:r,points:e,ends:o,starts:a}}var ea=.7,ta=32;function na(e,{ends:t,starts:n},r,{at:i,width:a,height:o,oneOf:s}){let c=-1,l=0,u=0;for(let d=n[r];d<n[r+1];d++){let f=t[d];if(s>1&&Math.floor(f/ta)%s)continue;let p=i[2*f],m=i[2*f+1],h=i[2*f-2],g=i[2*f-1];p<0&&h<0||m<0&&g<0||p>a&&h>a||m>o&&g>o||(c!==f-1&&(e.moveTo(h,g),l=h,u=g),c=f,d+1<n[r+1]&&t[d+1]===f+1&&Math.abs(p-l)+Math.abs(m-u)<ea||(e.lineTo(p,m),l=p,u=m))}}var ra={top:[[1,0,0],[0,1,0]],front:[[1,0,0],[0,0,1]],right:[[0,1,0],[0,0,1]],iso:[[Math.SQRT1_2,Math.SQRT1_2,0],[-.408248,.408248,.816497]]},[ia,aa]=[50,20],oa=256,sa=200,ca=class{gain=0;onPick=()=>{};#e;#t;#n=`top`;#r={x:0,y:0,scale:1};#i=!0;#a;#o;#s;#c;#l;#u=1;#d=[];#f;#p=new Float32Array;#m=0;#h=1;#g=-1/0;#_=0;#v;constructor(e){[this.#e,this.#t]=[0,1].map(()=>e.appendChild(document.createElement(`canvas`))),this.#t.tabIndex=0,this.#t.setAttribute(`role`,`img`),new ResizeObserver(()=>this.#D()).observe(e),this.#k()}get shownGain(){return this.#o?this.gain||this.#b():1}get largest_um(){return this.#u}describe(e){this.#t.setAttribute(`aria-label`,e)}program({points:e,kinds:t}){this.#a=$i(e,2,e=>t[e]&1),this.#v=ua(e),this.#i&&this.fit(),this.redraw()}cut(e,t){this.#o=e,this.#u=t||1,this.#d=[],this.#f=void 0,this.regain()}compare(e){this.#c=e,this.regain()}add(e){this.#d.push(e);let t=e.length-4;t>=0&&(this.#f=[e[t],e[t+1],e[t+2]]),this.redraw()}side(e){this.#n=e,this.fit()}fit(){if(this.#i=!0,!this.#v)return;let e=[0,1,2,3,4,5,6,7].map(e=>this.#w([0,1,2].map(t=>this.#v[e>>t&1][t]))),[t,n]=[e.map(([e])=>e),e.map(([,e])=>e)],[r,i,a,o]=[Math.min(...t),Math.max(...t),Math.min(...n),Math.max(...n)],{clientWidth:s,clientHeight:c}=this.#e,l=e=>Math.max(1,e-56),u=Math.min(l(s)/Math.max(i-r,1e-6),l(c)/Math.max(o-a,1e-6));this.#r={x:(r+i)/2,y:(a+o)/2,scale:Math.min(u,1e5)},this.redraw()}zoomTo(e){if(!this.#v)return;let[t,n]=this.#v,r=Math.hypot(n[0]-t[0],n[1]-t[1],n[2]-t[2]),[i,a]=this.#w(e);this.#i=!1,this.#r={x:i,y:a,scale:Math.min(this.#e.clientWidth,this.#e.clientHeight)/Math.max(.1*r,.001)},this.redraw()}tool(e){let t=this.#o,n=this.#s?.points;this.#f=t&&n&&e!==void 0?[0,1,2].map(t=>n[3*e+t]):void 0,this.#S()}redraw(){this.#m||=requestAnimationFrame(()=>{this.#m=0,this.draw()})}#y(){this.#i=!1,clearTimeout(this.#_),this.#_=setTimeout(()=>{this.#g=-1/0,this.redraw()},sa),this.#m||=requestAnimationFrame(e=>{this.#m=0;let t=e-this.#g;this.#g=e,t<1e3&&t>ia?this.#h=Math.min(oa,2*this.#h):t<aa&&(this.#h=Math.max(1,this.#h/2)),this.draw(this.#h)})}draw(e=1){let n=this.#e.getContext(`2d`),r=devicePixelRatio,{clientWidth:i,clientHeight:o}=this.#e;n.setTransform(r,0,0,r,0,0),n.clearRect(0,0,i,o),n.lineJoin=`round`,this.#C(n,i,o);let s=(t,r,a)=>{n.beginPath(),na(n,t,r,{at:a,width:i,height:o,oneOf:e}),n.stroke()};if(this.#a){let e=this.#E(this.#a.points);[n.lineWidth,n.strokeStyle]=[1,t(`--rapid`)],n.setLineDash([3,4]),s(this.#a,0,e),n.setLineDash([]),[n.lineWidth,n.strokeStyle]=[1,t(`--path`)],s(this.#a,1,e)}if(this.#l){let e=this.#E(this.#l.points);[n.lineWidth,n.strokeStyle]=[1,t(`--kept`)],s(this.#l,0,e)}if(this.#s){let e=this.#E(this.#s.points);n.lineWidth=this.#s.ends.length>3e4?1:1.8;for(let t=0;t<24;t++)n.strokeStyle=a((t+.5)/24),s(this.#s,t,e)}this.#x(n),this.#S()}regain(){let[e,t,n]=[this.#o,this.#c,this.shownGain],r=t=>e.cutting[t]?Math.min(23,Math.floor(24*Math.abs(e.error_um[t])/this.#u)):-1;this.#s=e&&$i(la(e,n),24,r),this.#l=e&&t&&$i(la(t,n),1,e=>t.cutting[e]?0:-1),this.redraw()}#b(){if(!this.#v)return 1;let[e,t]=this.#v,n=.02*Math.hypot(t[0]-e[0],t[1]-e[1])/(.001*this.#u),r=10**Math.floor(Math.log10(n));return Math.max(1,r*([5,2,1].find(e=>e*r<=n)??1))}#x(e){if(!this.#d.length)return;e.lineWidth=1.8,e.strokeStyle=t(`--run-1`),e.beginPath();let n=!1;for(let t of this.#d)for(let r=0;r<t.length;r+=4){let[i,a]=this.#T([t[r],t[r+1],t[r+2]]);Number.isNaN(t[r+3])?n=!1:n?e.lineTo(i,a):(e.moveTo(i,a),n=!0)}e.stroke()}#S(){let e=this.#t.getContext(`2d`),n=devicePixelRatio;if(e.setTransform(n,0,0,n,0,0),e.clearRect(0,0,this.#t.clientWidth,this.#t.clientHeight),!this.#f)return;let[r,i]=this.#T(this.#f);e.fillStyle=t(`--panel`),e.strokeStyle=t(`--ink`),e.lineWidth=2,e.beginPath(),e.arc(r,i,5,0,2*Math.PI),e.fill(),e.stroke()}#C(e,n,r){let{x:i,y:a,scale:o}=this.#r,s=64/o,c=10**Math.floor(Math.log10(s)),l=c*([2,5,10].find(e=>e*c>=s)??10);e.strokeStyle=t(`--grid`),e.lineWidth=1,e.beginPath();for(let t=Math.ceil((i-n/2/o)/l);t*l<i+n/2/o;t++){let a=Math.round(n/2+(t*l-i)*o)+.5;e.moveTo(a,0),e.lineTo(a,r)}for(let t=Math.ceil((a-r/2/o)/l);t*l<a+r/2/o;t++){let i=Math.round(r/2-(t*l-a)*o)+.5;e.moveTo(0,i),e.lineTo(n,i)}e.stroke(),this.onGrid(l,this.#n)}onGrid=()=>{};#w([e,t,n]){let[r,i]=ra[this.#n];return[r[0]*e+r[1]*t+r[2]*n,i[0]*e+i[1]*t+i[2]*n]}#T(e){let[t,n]=this.#w(e),{x:r,y:i,scale:a}=this.#r;return[this.#e.clientWidth/2+(t-r)*a,this.#e.clientHeight/2-(n-i)*a]}#E(e){let t=e.length/3,[n,r]=ra[this.#n],{x:i,y:a,scale:o}=this.#r;this.#p.length<2*t&&(this.#p=new Float32Array(2*t));let s=this.#p,[c,l]=[this.#e.clientWidth/2-i*o,this.#e.clientHeight/2+a*o];for(let i=0;i<t;i++){let t=e[3*i],a=e[3*i+1],u=e[3*i+2];s[2*i]=c+o*(n[0]*t+n[1]*a+n[2]*u),s[2*i+1]=l-o*(r[0]*t+r[1]*a+r[2]*u)}return s}#D(){for(let e of[this.#e,this.#t])e.width=Math.round(e.clientWidth*devicePixelRatio),e.height=Math.round(e.clientHeight*devicePixelRatio);this.#i&&this.fit(),this.draw()}pan(e,t){this.#r.x-=e/this.#r.scale,this.#r.y+=t/this.#r.scale,this.#y()}zoom(e,t=this.#e.clientWidth/2,n=this.#e.clientHeight/2){let r=this.#r,[i,a]=[t-this.#e.clientWidth/2,this.#e.clientHeight/2-n],o=Math.min(1e6,Math.max(1e-4,r.scale*e));r.x+=i/r.scale-i/o,r.y+=a/r.scale-a/o,r.scale=o,this.#y()}#O(e,t){if(!this.#s)return;let n=this.#E(this.#s.points),[r,i]=[void 0,576];for(let a=0;a<this.#s.count;a++){let o=(n[2*a]-e)**2+(n[2*a+1]-t)**2;o<i&&([r,i]=[a,o])}return r}#k(){let e=this.#t,t=new Map,n=0;e.addEventListener(`wheel`,e=>{e.preventDefault(),this.zoom(Math.exp(-.0015*e.deltaY*(e.deltaMode===1?16:1)),e.offsetX,e.offsetY)},{passive:!1}),e.addEventListener(`pointerdown`,r=>{e.setPointerCapture(r.pointerId),t.set(r.pointerId,{x:r.offsetX,y:r.offsetY}),t.size===1&&(n=0)}),e.addEventListener(`pointermove`,e=>{let r=t.get(e.pointerId);if(!r)return;let i={x:e.offsetX,y:e.offsetY},a=[...t].find(([t])=>t!==e.pointerId)?.[1];if(a){let e=e=>Math.hypot(e.x-a.x,e.y-a.y);this.zoom(e(i)/Math.max(1,e(r)),(i.x+a.x)/2,(i.y+a.y)/2)}let o=a?.5:1;this.pan(o*(i.x-r.x),o*(i.y-r.y)),n+=Math.abs(i.x-r.x)+Math.abs(i.y-r.y),t.set(e.pointerId,i)});let r=e=>{if(t.delete(e.pointerId)&&e.type===`pointerup`&&n<4){let t=this.#O(e.offsetX,e.offsetY);t!==void 0&&this.onPick(t)}};e.addEventListener(`pointerup`,r),e.addEventListener(`pointercancel`,r),e.addEventListener(`dblclick`,()=>this.fit());let i={ArrowLeft:()=>this.pan(40,0),ArrowRight:()=>this.pan(-40,0),ArrowUp:()=>this.pan(0,40),ArrowDown:()=>this.pan(0,-40),"+":()=>this.zoom(1.25),"=":()=>this.zoom(1.25),"-":()=>this.zoom(.8),0:()=>this.fit()};e.addEventListener(`keydown`,e=>{let t=!e.ctrlKey&&!e.metaKey&&i[e.key];t&&(e.preventDefault(),t())})}},la=({foot_mm:e,deviation_mm:t},n)=>e.map((e,r)=>e+n*t[r]);function ua(e){if(!e.length)return;let[t,n]=[[1/0,1/0,1/0],[-1/0,-1/0,-1/0]];for(let r=0;r<e.length;r++)t[r%3]=Math.min(t[r%3],e[r]),n[r%3]=Math.max(n[r%3],e[r]);return[t,n]}var X=new ca(o(`view`)),da=new Bi(o(`curve`)),fa=new Hi(o(`text`),o(`gutter`)),pa=new Qi(o(`play`),o(`time`),o(`speed`)),[ma,ha,ga]=[new Ki,new Ki,new Ki],_a=o(`machine`),va=o(`controller`),ya=o(`example`),ba=o(`control`),Z={name:`program.ngc`,lists:void 0,machineFile:void 0,checked:void 0,answer:void 0,corrected:void 0,kept:void 0,shown:0},xa=`file`;function Sa(){let e=_a.value===xa&&Z.machineFile;return{name:Z.name,program:fa.value,machine:e?`${Z.machineFile.text}\n`:_a.value,machine_name:e?Z.machineFile.name:void 0}}var Ca=()=>new Date().toISOString().slice(0,10);function wa(e,t,n=``){return Z.name=e,fa.value=t,ya.value=n,o(`name`).textContent=e,document.title=`${e} · feedwright`,o(`welcome`).hidden=!0,X.fit(),Q(),Qa(),$()}async function Ta(e){let t=wa(`${e}.ngc`,d[e].program,e);await Promise.all([t,ja()])}var Ea=2**29;async function Da(e){for(let t of e)try{if(t.size>=Ea)throw Error(`it has ${Ri(t.size)}, and a browser holds ${Ri(Ea)}. Use the command: feedwright run`);let e=await t.text();/\.toml$/i.test(t.name)?Oa(t.name,e):/\.(csv|log|json)$/i.test(t.name)?await Na(t.name,e):await wa(t.name,e)}catch(e){La(`${t.name} cannot be opened: ${e.message}`)}}function Oa(e,t){Z.machineFile={name:e,text:t},_a.querySelector(`[value=${xa}]`)?.remove(),_a.prepend(new Option(e,xa)),_a.value=xa,Q(),$()}function Q(){ha.cancel(),[Z.answer,Z.corrected,Z.shown]=[void 0,void 0,0],La(``),Va(),Ja()}var ka=0;async function $(){let e=++ka;if(ma.cancel(),!Z.lists||!fa.value.trim()){Z.checked=void 0,Ra();return}let t=setTimeout(()=>o(`amounts`).textContent=`Reading the program. If it does not end, change it, or press Esc.`,2e3);try{let t=await ma.ask({...Sa(),task:`check`});if(e!==ka)return;Z.checked=t,Ra()}catch(t){if(e!==ka)return;o(`amounts`).textContent=``,t instanceof Gi||La(String(t.message))}finally{clearTimeout(t)}}async function Aa(e){ha.cancel(),La(``);let t=performance.now(),n=``,r=(e,r)=>{e!==n&&([n,t]=[e,performance.now()]);let i=(performance.now()-t)/1e3*(1/r-1);o(`stage`).textContent=e,o(`bar`).value=r,o(`left`).textContent=r>.05&&r<1&&i>=1?`${Math.ceil(i)} s left in this step`:``};Fa(!0),r(`starting`,0);try{await e(r)}catch(e){if(e instanceof Gi)return;La(String(e.message))}Fa(!1)}async function ja(){await Aa(async e=>{X.cut(void 0,1);let t={...Sa(),task:`run`,controller:va.value,recorded_on:Ca(),page:!0};Z.answer=await ha.ask(t,{progress:e,points:e=>X.add(e)}),Va()}),Z.answer||X.cut(void 0,1)}async function Ma(){await Aa(async e=>{Z.corrected=await ha.ask({...Sa(),task:`correct`,target:ba.value},{progress:e}),Ja()})}async function Na(e,t){await Aa(async n=>{let r=e.replace(/\.[^.]*$/,``),i=await ha.ask({task:`identify`,name:e,program:t},{progress:n});Oa(`${r}.toml`,i.file),Ji(r,e,i)})}function Pa(){ma.cancel(),ha.cancel(),Fa(!1),Z.answer||X.cut(void 0,1)}function Fa(e){o(`work`).hidden=!e,document.body.classList.toggle(`busy`,e),Ia()}function Ia(){let e=!!Z.lists&&!!Z.checked?.amounts&&o(`work`).hidden;for(let t of[`run`,`correct`])o(t).disabled=!e}function La(e){o(`message`).textContent=e,o(`message`).hidden=!e}function Ra(){let{checked:e}=Z,t=e?.findings??[];e&&X.program(e),fa.mark(t),o(`findings`).replaceChildren(...t.slice(0,200).map(za));let n=e?.amounts,r=t.filter(({severity:e})=>e===`error`).length;o(`amounts`).textContent=n?`${n.lines} lines, ${n.motions} motions, ${Li(n.feed_mm)} of cuts, ${Li(n.rapid_mm)} of rapids. Read as ${n.dialect}.`:r?`${r} mistake${r===1?``:`s`}: nothing can be cut.`:``,Ia()}function za(e){let t=s(`li`,``,e.severity),n=s(`button`);return n.type=`button`,n.append(s(`b`,`${e.line}:${e.column} ${e.severity}`),` ${e.message}`),e.hint&&n.append(s(`small`,`hint: ${e.hint}`)),n.addEventListener(`click`,()=>fa.go(e)),t.append(n),t}var Ba=e=>Math.max(...e.map(({figures:e})=>Number(e.max_um)).filter(Number.isFinite),0);function Va(){let{answer:e}=Z,t=e?.cuts??[],n=Ha();for(let t of[`figures`,`report`,`keep`,`worst-title`,`legend`])o(t).hidden=!e;o(`keep`).setAttribute(`aria-pressed`,String(!!Z.kept)),o(`verdict`).textContent=e?.verdict.split(` Cost:`)[0]??`Run shows what the machine will cut without a correction and with the controller.`,Wa(o(`figures`),n.map(({figures:e})=>e),n.map(({look:e})=>e)),o(`shown`).replaceChildren(...t.map(({figures:e},t)=>{let n=s(`button`,e.name);return n.type=`button`,n.addEventListener(`click`,()=>Ga(t)),n})),da.show(n),o(`key`).replaceChildren(s(`b`,`Contour error over time`),...n.map(({figures:e,look:t})=>s(`span`,e.name,`run ${t}`))),Ga(Math.min(Z.shown,Math.max(0,t.length-1)))}function Ha(){let{answer:e,kept:t}=Z;return!e||!t?e?.cuts??[]:e.cuts.some(({t_s:e})=>e===t.t_s)?e.cuts:[...e.cuts,t]}function Ua(){let e=Z.answer?.cuts[Z.shown],t=`${e?.figures.name} before: ${Z.name} on ${_a.selectedOptions[0].text}`;Z.kept=Z.kept||!e?void 0:{...e,look:`kept`,figures:{...e.figures,name:t}},Va()}function Wa(e,t,n=[]){e.querySelectorAll(`.unit`).forEach(e=>e.textContent=Ni()),e.querySelector(`tbody`).replaceChildren(...t.map((e,t)=>{let r=s(`tr`),i=s(`th`,e.name,n[t]?`run ${n[t]}`:``);return i.scope=`row`,r.append(i,...[e.time_s,Fi(e.rms_um),Fi(e.max_um)].map(e=>s(`td`,e))),r}))}function Ga(e){Z.shown=e;let t=Z.answer?.cuts??[],n=t[e];[...o(`shown`).children].forEach((t,n)=>t.setAttribute(`aria-pressed`,String(n===e))),X.cut(n,Ba(t)),X.compare(Ha()[t.length]),pa.show(n),o(`readout`).textContent=``,o(`largest`).textContent=`${Fi(Ba(t))} ${Ni()}`,o(`worst`).replaceChildren(...(n?.worst??[]).map(e=>Ka(e))),qa(),X.describe(n?`Path of ${Z.name}, ${n.figures.name}: largest contour error ${Fi(n.figures.max_um)} ${Ni()}. Arrow keys move, + and − zoom, 0 fits.`:`Path of ${Z.name}`)}function Ka(e){let t=s(`li`),n=s(`button`);return n.type=`button`,n.append(s(`b`,`${Fi(Math.abs(e.error_um))} ${Ni()}`),s(`span`,`line ${e.line}`),s(`code`,e.text)),n.addEventListener(`click`,()=>{X.zoomTo(e.position_mm),pa.time(e.t_s),t.parentElement.querySelectorAll(`[aria-current]`).forEach(e=>e.removeAttribute(`aria-current`)),n.setAttribute(`aria-current`,`true`)}),t.append(n),t}function qa(){let e=X.shownGain;o(`gain-now`).textContent=e>1?`errors drawn ${e} times too large`:``}function Ja(){let{corrected:e}=Z;if(o(`corrected`).hidden=!e,!e)return;Wa(o(`corrected`),e.figures);let{refusal:t,hint:n,stretches:r,stretches_changed:i,rounds:a}=e;o(`correction`).textContent=t?`No corrected program: ${t}.${n?` Hint: ${n}.`:``}`:`${i} of ${r} stretches between corners were changed, found in ${a} simulated cuts. Both cut without feedback, as the control plans them.`;for(let n of[`download`,`take`])o(n).hidden=!e.program||!!t}function Ya(e){let t=Z.answer?.cuts[Z.shown];if(!t)return;X.tool(e),da.tool(t.t_s[e]),fa.current(t.line[e]);let n=[0,1,2].map(n=>Ii(t.foot_mm[3*e+n]+t.deviation_mm[3*e+n])),r=t.cutting[e]?`error ${Fi(Math.abs(t.error_um[e]))} ${Ni()}`:`rapid or rest`;o(`readout`).textContent=`${t.t_s[e].toFixed(3)} s   line ${t.line[e]}   X ${n[0]}  Y ${n[1]}  Z ${n[2]} ${Mi()}   ${r}`}function Xa(){let e=o(`colors`),t=e.getContext(`2d`);for(let n=0;n<e.width;n++)t.fillStyle=a(n/e.width),t.fillRect(n,0,1,e.height)}var Za=()=>Z.name.replace(/\.[^.]*$/,``);function Qa(){let{lists:e}=Z;if(!e)return;let t=new URLSearchParams;ya.value&&t.set(`example`,ya.value),_a.value!==xa&&_a.value!==e.machine&&t.set(`machine`,_a.value),va.value!==e.controller&&t.set(`controller`,va.value),ba.value!==e.control&&t.set(`control`,ba.value),Mi()!==`mm`&&t.set(`units`,Mi()),history.replaceState(null,``,t.size?`#${t}`:location.pathname)}function $a(){let e=new URLSearchParams(location.hash.slice(1)),t=(t,n)=>{let r=e.get(n);r&&[...t.options].some(e=>e.value===r)&&(t.value=r)};t(_a,`machine`),t(va,`controller`),t(ba,`control`),e.get(`units`)===`in`&&eo(`in`);let n=e.get(`example`)??``;return Object.hasOwn(d,n)?n:``}function eo(e){ji(e),c(`[data-units]`,t=>t.dataset.units===e)}function to(){o(`open`).addEventListener(`click`,()=>o(`file`).click()),o(`file`).addEventListener(`change`,e=>{let t=e.target;Da([...t.files??[]]).then(()=>t.value=``)}),ya.addEventListener(`change`,()=>ya.value&&Ta(ya.value));let e=0;fa.onChange=()=>{ya.value=``,o(`welcome`).hidden=!0,clearTimeout(e),e=setTimeout(()=>{Q(),Qa(),$()},200)};for(let e of[_a,va])e.addEventListener(`change`,()=>{Q(),Qa(),$()});ba.addEventListener(`change`,()=>{Z.corrected=void 0,Ja(),Qa()}),o(`run`).addEventListener(`click`,()=>void ja()),o(`correct`).addEventListener(`click`,Ma),o(`cancel`).addEventListener(`click`,Pa),document.addEventListener(`keydown`,e=>{e.key===`Enter`&&(e.ctrlKey||e.metaKey)?o(`run`).click():e.key===`Escape`&&Pa()}),no(),Zi(),ro(),K(Da)}function no(){o(`report`).addEventListener(`click`,()=>Z.answer&&u(`${Za()}.report.html`,Z.answer.report)),o(`keep`).addEventListener(`click`,Ua);let e=()=>new Blob([Z.corrected.program],{type:`text/plain`});o(`download`).addEventListener(`click`,()=>Z.corrected&&u(`${Za()}.corrected.ngc`,e())),o(`take`).addEventListener(`click`,()=>Z.corrected&&wa(`${Za()}.corrected.ngc`,Z.corrected.program))}function ro(){document.querySelectorAll(`[data-units]`).forEach(e=>e.addEventListener(`click`,()=>{eo(e.dataset.units),Qa(),Ra(),Va(),Ja()})),document.querySelectorAll(`[data-side]`).forEach(e=>e.addEventListener(`click`,()=>{X.side(e.dataset.side),c(`[data-side]`,t=>t===e)})),o(`fit`).addEventListener(`click`,()=>X.fit()),o(`gain`).addEventListener(`change`,e=>{X.gain=Number(e.target.value),X.regain(),qa()}),X.onGrid=(e,t)=>{let n={top:`X right, Y up`,front:`X right, Z up`,right:`Y right, Z up`,iso:`from the front left, above`}[t];o(`scale`).textContent=Z.checked?`grid ${Li(e)} · ${n}`:``},X.onPick=e=>{pa.stop(),pa.index(e)},da.onPick=e=>{pa.stop(),pa.time(e)},pa.onMove=Ya,matchMedia(`(prefers-color-scheme: dark)`).addEventListener(`change`,()=>{Xa(),X.redraw(),da.show(Ha())})}async function io(){let e=await(await fetch(`files.json`)).json();if(!e)return void navigator.serviceWorker?.register(`offline.js`).catch(()=>{});let t=e.map(async(e,t)=>new File([await(await fetch(`files/${t}`)).blob()],e));await Da(await Promise.all(t))}async function ao(){to(),Xa();for(let[e,{about:t}]of Object.entries(d))ya.append(Object.assign(new Option(e,e),{title:t}));try{await Y();let e=Z.lists=await ga.ask({task:`lists`});l(_a,e.machines,e.machine),l(va,e.controllers,e.controller),l(ba,e.controls,e.control),o(`version`).textContent=`feedwright ${e.version}.`;let t=$a();await io(),t&&!fa.value?await Ta(t):fa.value?Z.checked||await $():await f(ga,Ta)}catch(e){La(`The engine does not start: ${e.message}. Load the page again.`)}ga.cancel()}Object.assign(globalThis,{feedwright:{view:X}}),ao();