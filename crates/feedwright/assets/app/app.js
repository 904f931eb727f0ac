var e=e=>document.getElementById(e);function t(e,t=``,n=``){let r=document.createElement(e);return[r.textContent,r.className]=[t,n],r}function n(e,t){document.querySelectorAll(e).forEach(e=>e.setAttribute(`aria-pressed`,String(t(e))))}function r(e,t,n){e.append(...t.map(({name:e,about:t})=>{let r=new Option(e,e,e===n,e===n);return r.title=t,r}))}function i(e,n){let r=t(`a`);r.href=URL.createObjectURL(n),r.download=e,r.click(),setTimeout(()=>URL.revokeObjectURL(r.href),6e4)}var a=25.4,o=`mm`,s=e=>{o=e},c=()=>o,l=()=>o===`mm`?`µm`:`thou`,u=e=>o===`mm`?e:e/a;function d(e){let t=Number(e);return e===`-`||!Number.isFinite(t)?`–`:o===`in`?(t/a).toFixed(3):typeof e==`string`?e:e.toFixed(2)}function f(e){let t=(o===`mm`?e:e/a).toFixed(o===`mm`?3:4);return Number(t)===0?t.replace(`-`,``):t.replace(`-`,`−`)}var p=e=>`${Number((o===`mm`?e:e/a).toPrecision(3))} ${o}`,m=e=>`${Number((e/1e6).toPrecision(3))} MB`,h=[`machine`,`controller`,`control`],g=`file`,_=t=>e(t);function v(e,t){let n=new URLSearchParams,r=_(`example`).value;r?n.set(`example`,r):t&&n.set(`part`,t);for(let t of h){let{value:r}=_(t);r!==e[t]&&r!==`file`&&n.set(t,r)}c()!==`mm`&&n.set(`units`,c()),history.replaceState(null,``,n.size?`#${n}`:location.pathname)}function y(){let e=new URLSearchParams(location.hash.slice(1)),t=e.get(`part`)??``;for(let t of h){let n=e.get(t),r=_(t);n&&[...r.options].some(e=>e.value===n)&&(r.value=n)}return{example:e.get(`example`)??``,part:/^\w[\w.-]*$/.test(t)?t:``,units:e.get(`units`)===`in`?`in`:`mm`}}var b=document.documentElement,x=document.createElement(`span`);x.hidden=!0,document.body.append(x);function S(e){return x.style.color=`var(${e})`,getComputedStyle(x).color}function C(){let e=b.dataset.theme;return e?e===`dark`:matchMedia(`(prefers-color-scheme: dark)`).matches}var w=[[104,148,205],[127,143,208],[138,104,186],[141,63,159],[124,18,119],[62,0,66]],T=[[74,110,184],[44,128,160],[38,158,140],[74,190,110],[160,218,57],[253,231,37]];function E(e){let t=Math.min(1,Math.max(0,e)),n=C()?T:w,r=t*(n.length-1),i=Math.min(n.length-2,Math.floor(r)),a=r-i;return`rgb(${n[i].map((e,t)=>Math.round(e+a*(n[i+1][t]-e))).join(`,`)})`}var D={star:{about:`Rounded star, 220 arcs`,program:`(Rounded five-pointed star: 12 + 4 cos 5a times cos a, sin a, a from 0 to 360 degrees, mm)
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
`}};async function O(n,r){let i=Object.entries(D).map(([e,{about:n}])=>{let i=t(`button`),a=t(`canvas`);return i.type=`button`,i.dataset.example=e,a.setAttribute(`aria-hidden`,`true`),i.append(a,t(`b`,e),t(`span`,n)),i.addEventListener(`click`,()=>r(e)),{card:i,canvas:a,name:e}});e(`cards`).replaceChildren(...i.map(({card:e})=>e));for(let{canvas:e,name:t}of i){let{points:r,kinds:i}=await n.ask({task:`check`,name:t,program:D[t].program});k(e,r,i)}}function k(e,t,n){let r=e.getContext(`2d`),i=devicePixelRatio,{clientWidth:a,clientHeight:o}=e;[e.width,e.height]=[a*i,o*i];let s=e=>t.filter((t,n)=>n%3===e),[c,l]=[s(0),s(1)],[u,d,f,p]=[Math.min(...c),Math.max(...c),Math.min(...l),Math.max(...l)],m=Math.min((a-8)/(d-u||1),(o-8)/(p-f||1));r.setTransform(i,0,0,i,a*i/2,o*i/2),r.strokeStyle=E(.1),r.lineWidth=1.5,r.beginPath(),c.forEach((e,t)=>{let i=[(e-(u+d)/2)*m,-(l[t]-(f+p)/2)*m];n[t]&1?r.lineTo(...i):r.moveTo(...i)}),r.stroke()}var ee=!0,te=`uplot`,ne=`u-hz`,re=`u-vt`,ie=`u-title`,ae=`u-wrap`,oe=`u-under`,se=`u-over`,ce=`u-axis`,le=`u-off`,ue=`u-select`,de=`u-cursor-x`,fe=`u-cursor-y`,pe=`u-cursor-pt`,me=`u-legend`,he=`u-live`,ge=`u-inline`,_e=`u-series`,ve=`u-marker`,ye=`u-label`,be=`u-value`,xe=`width`,Se=`height`,Ce=`top`,we=`bottom`,Te=`left`,Ee=`right`,A=`#000`,De=`#0000`,Oe=`mousemove`,ke=`mousedown`,Ae=`mouseup`,je=`mouseenter`,Me=`mouseleave`,Ne=`dblclick`,Pe=`resize`,Fe=`scroll`,Ie=`change`,Le=`dppxchange`,Re=`--`,ze=typeof window<`u`,Be=ze?document:null,Ve=ze?window:null,He=ze?navigator:null,j,Ue;function M(){let e=devicePixelRatio;j!=e&&(j=e,Ue&&nt(Ie,Ue,M),Ue=matchMedia(`(min-resolution: ${j-.001}dppx) and (max-resolution: ${j+.001}dppx)`),tt(Ie,Ue,M),Ve.dispatchEvent(new CustomEvent(Le)))}function We(e,t){if(t!=null){let n=e.classList;!n.contains(t)&&n.add(t)}}function Ge(e,t){let n=e.classList;n.contains(t)&&n.remove(t)}function N(e,t,n){e.style[t]=n+`px`}function Ke(e,t,n,r){let i=Be.createElement(e);return t!=null&&We(i,t),n?.insertBefore(i,r),i}function qe(e,t){return Ke(`div`,e,t)}var P=new WeakMap;function Je(e,t,n,r,i){let a=`translate(`+t+`px,`+n+`px)`;a!=P.get(e)&&(e.style.transform=a,P.set(e,a),t<0||n<0||t>r||n>i?We(e,le):Ge(e,le))}var Ye=new WeakMap;function Xe(e,t,n){let r=t+n;r!=Ye.get(e)&&(Ye.set(e,r),e.style.background=t,e.style.borderColor=n)}var Ze=new WeakMap;function Qe(e,t,n,r){let i=t+``+n;i!=Ze.get(e)&&(Ze.set(e,i),e.style.height=n+`px`,e.style.width=t+`px`,e.style.marginLeft=r?-t/2+`px`:0,e.style.marginTop=r?-n/2+`px`:0)}var $e={passive:!0},et={...$e,capture:!0};function tt(e,t,n,r){t.addEventListener(e,n,r?et:$e)}function nt(e,t,n,r){t.removeEventListener(e,n,$e)}ze&&M();function rt(e,t,n,r){let i;n||=0,r||=t.length-1;let a=r<=2147483647;for(;r-n>1;)i=a?n+r>>1:wt((n+r)/2),t[i]<e?n=i:r=i;return e-t[n]<=t[r]-e?n:r}function it(e){return(t,n,r)=>{let i=-1,a=-1;for(let a=n;a<=r;a++)if(e(t[a])){i=a;break}for(let i=r;i>=n;i--)if(e(t[i])){a=i;break}return[i,a]}}var at=e=>e!=null,ot=e=>e!=null&&e>0,st=it(at),ct=it(ot);function lt(e,t,n,r=0,i=!1){let a=i?ct:st,o=i?ot:at;[t,n]=a(e,t,n);let s=e[t],c=e[t];if(t>-1){if(r==1)s=e[t],c=e[n];else if(r==-1)s=e[n],c=e[t];else for(let r=t;r<=n;r++){let t=e[r];o(t)&&(t<s?s=t:t>c&&(c=t))}}return[s??I,c??-I]}function ut(e,t,n,r){let i=At(e),a=At(t);e==t&&(i==-1?(e*=n,t/=n):(e/=n,t*=n));let o=n==10?jt:Mt,s=i==1?wt:Et,c=a==1?Et:wt,l=s(o(Ct(e))),u=c(o(Ct(t))),d=kt(n,l),f=kt(n,u);return n==10&&(l<0&&(d=V(d,-l)),u<0&&(f=V(f,-u))),r||n==2?(e=d*i,t=f*a):(e=Gt(e,d),t=Wt(t,f)),[e,t]}function dt(e,t,n,r){let i=ut(e,t,n,r);return e==0&&(i[0]=0),t==0&&(i[1]=0),i}var ft=.1,pt={mode:3,pad:ft},mt={pad:0,soft:null,mode:0},ht={min:mt,max:mt};function gt(e,t,n,r){return nn(n)?vt(e,t,n):(mt.pad=n,mt.soft=r?0:null,mt.mode=r?3:0,vt(e,t,ht))}function F(e,t){return e??t}function _t(e,t,n){for(t=F(t,0),n=F(n,e.length-1);t<=n;){if(e[t]!=null)return!0;t++}return!1}function vt(e,t,n){let r=n.min,i=n.max,a=F(r.pad,0),o=F(i.pad,0),s=F(r.hard,-I),c=F(i.hard,I),l=F(r.soft,I),u=F(i.soft,-I),d=F(r.mode,0),f=F(i.mode,0),p=t-e,m=jt(p),h=Ot(Ct(e),Ct(t)),g=Ct(jt(h)-m);(p<1e-24||g>10)&&(p=0,(e==0||t==0)&&(p=1e-24,d==2&&l!=I&&(a=0),f==2&&u!=-I&&(o=0)));let _=p||h||1e3,v=kt(10,wt(jt(_))),y=V(Gt(e-_*(p==0?e==0?.1:1:a),v/10),24),b=e>=l&&(d==1||d==3&&y<=l||d==2&&y>=l)?l:I,x=Ot(s,y<b&&e>=b?b:Dt(b,y)),S=V(Wt(t+_*(p==0?t==0?.1:1:o),v/10),24),C=t<=u&&(f==1||f==3&&S>=u||f==2&&S<=u)?u:-I,w=Dt(c,S>C&&t<=C?C:Ot(C,S));return x==w&&x==0&&(w=100),[x,w]}var yt=new Intl.NumberFormat(ze?He.language:`en-US`),bt=e=>yt.format(e),xt=Math,St=xt.PI,Ct=xt.abs,wt=xt.floor,Tt=xt.round,Et=xt.ceil,Dt=xt.min,Ot=xt.max,kt=xt.pow,At=xt.sign,jt=xt.log10,Mt=xt.log2,Nt=(e,t=1)=>xt.sinh(e)*t,Pt=(e,t=1)=>xt.asinh(e/t),I=1/0;function Ft(e){return(jt((e^e>>31)-(e>>31))|0)+1}function It(e,t,n){return Dt(Ot(e,t),n)}function Lt(e){return typeof e==`function`}function L(e){return Lt(e)?e:()=>e}var Rt=()=>{},R=e=>e,zt=(e,t)=>t,Bt=e=>null,Vt=e=>!0,Ht=(e,t)=>e==t,z=/\.\d*?(?=9{6,}|0{6,})/gm,B=e=>{if($t(e)||Kt.has(e))return e;let t=`${e}`,n=t.match(z);if(n==null)return e;let r=n[0].length-1;if(t.indexOf(`e-`)!=-1){let[e,n]=t.split(`e`);return+`${B(e)}e${n}`}return V(e,r)};function Ut(e,t){return B(V(B(e/t))*t)}function Wt(e,t){return B(Et(B(e/t))*t)}function Gt(e,t){return B(wt(B(e/t))*t)}function V(e,t=0){if($t(e))return e;let n=10**t;return Tt(e*n*(1+2**-52))/n}var Kt=new Map;function qt(e){return((``+e).split(`.`)[1]||``).length}function Jt(e,t,n,r){let i=[],a=r.map(qt);for(let o=t;o<n;o++){let t=Ct(o),n=V(kt(e,o),t);for(let s=0;s<r.length;s++){let c=e==10?+`${r[s]}e${o}`:r[s]*n,l=(o>=0?0:t)+(o>=a[s]?0:a[s]),u=e==10?c:V(c,l);i.push(u),Kt.set(u,l)}}return i}var Yt={},Xt=[],Zt=[null,null],Qt=Array.isArray,$t=Number.isInteger,en=e=>e===void 0;function tn(e){return typeof e==`string`}function nn(e){let t=!1;if(e!=null){let n=e.constructor;t=n==null||n==Object}return t}function rn(e){return typeof e==`object`&&!!e}var an=Object.getPrototypeOf(Uint8Array),on=`__proto__`;function sn(e,t=nn){let n;if(Qt(e)){let r=e.find(e=>e!=null);if(Qt(r)||t(r)){n=Array(e.length);for(let r=0;r<e.length;r++)n[r]=sn(e[r],t)}else n=e.slice()}else if(e instanceof an)n=e.slice();else if(t(e)){n={};for(let r in e)r!=on&&(n[r]=sn(e[r],t))}else n=e;return n}function H(e){let t=arguments;for(let n=1;n<t.length;n++){let r=t[n];for(let t in r)t!=on&&(nn(e[t])?H(e[t],sn(r[t])):e[t]=sn(r[t]))}return e}var cn=0,ln=1,un=2;function dn(e,t,n){for(let r=0,i,a=-1;r<t.length;r++){let o=t[r];if(o>a){for(i=o-1;i>=0&&e[i]==null;)e[i--]=null;for(i=o+1;i<n&&e[i]==null;)e[a=i++]=null}}}function fn(e,t){if(hn(e)){let t=e[0].slice();for(let n=1;n<e.length;n++)t.push(...e[n].slice(1));return gn(t[0])||(t=mn(t)),t}let n=new Set;for(let t=0;t<e.length;t++){let r=e[t][0],i=r.length;for(let e=0;e<i;e++)n.add(r[e])}let r=[Array.from(n).sort((e,t)=>e-t)],i=r[0].length,a=new Map;for(let e=0;e<i;e++)a.set(r[0][e],e);for(let n=0;n<e.length;n++){let o=e[n],s=o[0];for(let e=1;e<o.length;e++){let c=o[e],l=Array(i).fill(void 0),u=t?t[n][e]:ln,d=[];for(let e=0;e<c.length;e++){let t=c[e],n=a.get(s[e]);t===null?u!=cn&&(l[n]=t,u==un&&d.push(n)):l[n]=t}dn(l,d,i),r.push(l)}}return r}var pn=typeof queueMicrotask>`u`?e=>Promise.resolve().then(e):queueMicrotask;function mn(e){let t=e[0],n=t.length,r=Array(n);for(let e=0;e<r.length;e++)r[e]=e;r.sort((e,n)=>t[e]-t[n]);let i=[];for(let t=0;t<e.length;t++){let a=e[t],o=Array(n);for(let e=0;e<n;e++)o[e]=a[r[e]];i.push(o)}return i}function hn(e){let t=e[0][0],n=t.length;for(let r=1;r<e.length;r++){let i=e[r][0];if(i.length!=n)return!1;if(i!=t){for(let e=0;e<n;e++)if(i[e]!=t[e])return!1}}return!0}function gn(e,t=100){let n=e.length;if(n<=1)return!0;let r=0,i=n-1;for(;r<=i&&e[r]==null;)r++;for(;i>=r&&e[i]==null;)i--;if(i<=r)return!0;let a=Ot(1,wt((i-r+1)/t));for(let t=e[r],n=r+a;n<=i;n+=a){let r=e[n];if(r!=null){if(r<=t)return!1;t=r}}return!0}var _n=[`January`,`February`,`March`,`April`,`May`,`June`,`July`,`August`,`September`,`October`,`November`,`December`],vn=[`Sunday`,`Monday`,`Tuesday`,`Wednesday`,`Thursday`,`Friday`,`Saturday`];function yn(e){return e.slice(0,3)}var bn=vn.map(yn),xn={MMMM:_n,MMM:_n.map(yn),WWWW:vn,WWW:bn};function Sn(e){return(e<10?`0`:``)+e}function Cn(e){return(e<10?`00`:e<100?`0`:``)+e}var wn={YYYY:e=>e.getFullYear(),YY:e=>(e.getFullYear()+``).slice(2),MMMM:(e,t)=>t.MMMM[e.getMonth()],MMM:(e,t)=>t.MMM[e.getMonth()],MM:e=>Sn(e.getMonth()+1),M:e=>e.getMonth()+1,DD:e=>Sn(e.getDate()),D:e=>e.getDate(),WWWW:(e,t)=>t.WWWW[e.getDay()],WWW:(e,t)=>t.WWW[e.getDay()],HH:e=>Sn(e.getHours()),H:e=>e.getHours(),h:e=>{let t=e.getHours();return t==0?12:t>12?t-12:t},AA:e=>e.getHours()>=12?`PM`:`AM`,aa:e=>e.getHours()>=12?`pm`:`am`,a:e=>e.getHours()>=12?`p`:`a`,mm:e=>Sn(e.getMinutes()),m:e=>e.getMinutes(),ss:e=>Sn(e.getSeconds()),s:e=>e.getSeconds(),fff:e=>Cn(e.getMilliseconds())};function Tn(e,t){t||=xn;let n=[],r=/\{([a-z]+)\}|[^{]+/gi,i;for(;i=r.exec(e);)n.push(i[0][0]==`{`?wn[i[1]]:i[0]);return e=>{let r=``;for(let i=0;i<n.length;i++)r+=typeof n[i]==`string`?n[i]:n[i](e,t);return r}}var En=new Intl.DateTimeFormat().resolvedOptions().timeZone;function Dn(e,t){let n;return t==`UTC`||t==`Etc/UTC`?n=new Date(+e+e.getTimezoneOffset()*6e4):t==En?n=e:(n=new Date(e.toLocaleString(`en-US`,{timeZone:t})),n.setMilliseconds(e.getMilliseconds())),n}var On=e=>e%1==0,kn=[1,2,2.5,5],An=Jt(10,-32,0,kn),jn=Jt(10,0,32,kn),Mn=jn.filter(On),Nn=An.concat(jn),Pn=`
`,Fn=`{YYYY}`,In=Pn+Fn,Ln=`{M}/{D}`,Rn=Pn+Ln,zn=Rn+`/{YY}`,Bn=`{aa}`,Vn=`{h}:{mm}`+Bn,Hn=Pn+Vn,Un=`:{ss}`,U=null;function W(e){let t=e*1e3,n=t*60,r=n*60,i=r*24,a=i*30,o=i*365,s=(e==1?Jt(10,0,3,kn).filter(On):Jt(10,-3,0,kn)).concat([t,t*5,t*10,t*15,t*30,n,n*5,n*10,n*15,n*30,r,r*2,r*3,r*4,r*6,r*8,r*12,i,i*2,i*3,i*4,i*5,i*6,i*7,i*8,i*9,i*10,i*15,a,a*2,a*3,a*4,a*6,o,o*2,o*5,o*10,o*25,o*50,o*100]),c=[[o,Fn,U,U,U,U,U,U,1],[i*28,`{MMM}`,In,U,U,U,U,U,1],[i,Ln,In,U,U,U,U,U,1],[r,`{h}`+Bn,zn,U,Rn,U,U,U,1],[n,Vn,zn,U,Rn,U,U,U,1],[t,Un,zn+` `+Vn,U,Rn+` `+Vn,U,Hn,U,1],[e,Un+`.{fff}`,zn+` `+Vn,U,Rn+` `+Vn,U,Hn,U,1]];function l(t){return(s,c,l,u,d,f)=>{let p=[],m=d>=o,h=d>=a&&d<o,g=t(l),_=V(g*e,3),v=G(g.getFullYear(),m?0:g.getMonth(),h||m?1:g.getDate()),y=V(v*e,3);if(h||m){let n=h?d/a:0,r=m?d/o:0,i=_==y?_:V(G(v.getFullYear()+r,v.getMonth()+n,1)*e,3),s=new Date(Tt(i/e)),c=s.getFullYear(),l=s.getMonth();for(let a=0;i<=u;a++){let o=G(c+r*a,l+n*a,1),s=o-t(V(o*e,3));i=V((+o+s)*e,3),i<=u&&p.push(i)}}else{let a=d>=i?i:d,o=y+(wt(l)-wt(_))+Wt(_-y,a);p.push(o);let m=t(o),h=m.getHours()+m.getMinutes()/n+m.getSeconds()/r,g=d/r,v=f/s.axes[c]._space;for(;o=V(o+d,e==1?0:3),!(o>u);)if(g>1){let e=wt(V(h+g,6))%24,n=t(o).getHours()-e;n>1&&(n=-1),o-=n*r,h=(h+g)%24;let i=p[p.length-1];V((o-i)/d,3)*v>=.7&&p.push(o)}else p.push(o)}return p}}return[s,c,l]}var[Wn,Gn,Kn]=W(1),[qn,Jn,Yn]=W(.001);Jt(2,-53,53,[1]);function Xn(e,t){return e.map(e=>e.map((n,r)=>r==0||r==8||n==null?n:t(r==1||e[8]==0?n:e[1]+n)))}function Zn(e,t){return(n,r,i,a,o)=>{let s=t.find(e=>o>=e[0])||t[t.length-1],c,l,u,d,f,p;return r.map(t=>{let n=e(t),r=n.getFullYear(),i=n.getMonth(),a=n.getDate(),o=n.getHours(),m=n.getMinutes(),h=n.getSeconds(),g=r!=c&&s[2]||i!=l&&s[3]||a!=u&&s[4]||o!=d&&s[5]||m!=f&&s[6]||h!=p&&s[7]||s[1];return c=r,l=i,u=a,d=o,f=m,p=h,g(n)})}}function Qn(e,t){let n=Tn(t);return(t,r,i,a,o)=>r.map(t=>n(e(t)))}function G(e,t,n){return new Date(e,t,n)}function $n(e,t){return t(e)}var er=`{YYYY}-{MM}-{DD} {h}:{mm}{aa}`;function tr(e,t){return(n,r,i,a)=>a==null?Re:t(e(r))}function nr(e,t){let n=e.series[t];return n.width?n.stroke(e,t):n.points.width?n.points.stroke(e,t):null}function rr(e,t){return e.series[t].fill(e,t)}var ir={show:!0,live:!0,isolate:!1,mount:Rt,markers:{show:!0,width:2,stroke:nr,fill:rr,dash:`solid`},idx:null,idxs:null,values:[]};function ar(e,t){let n=e.cursor.points,r=qe(),i=n.size(e,t);N(r,xe,i),N(r,Se,i);let a=i/-2;N(r,`marginLeft`,a),N(r,`marginTop`,a);let o=n.width(e,t,i);return o&&N(r,`borderWidth`,o),r}function or(e,t){let n=e.series[t].points;return n._fill||n._stroke}function sr(e,t){let n=e.series[t].points;return n._stroke||n._fill}function cr(e,t){return e.series[t].points.size}var lr=[0,0];function ur(e,t,n){return lr[0]=t,lr[1]=n,lr}function dr(e,t,n,r=!0){return e=>{e.button!=0||r&&e.target!=t||n(e)}}function fr(e,t,n,r=!0){return e=>{r&&e.target!=t||n(e)}}var pr={show:!0,x:!0,y:!0,lock:!1,move:ur,points:{one:!1,show:ar,size:cr,width:0,stroke:sr,fill:or},bind:{mousedown:dr,mouseup:dr,click:dr,dblclick:dr,mousemove:fr,mouseleave:fr,mouseenter:fr},drag:{setScale:!0,x:!0,y:!1,dist:0,uni:null,click:(e,t)=>{t.stopPropagation(),t.stopImmediatePropagation()},_x:!1,_y:!1},focus:{dist:(e,t,n,r,i)=>r-i,prox:-1,bias:0},hover:{skip:[void 0],prox:null,bias:0},left:-10,top:-10,idx:null,dataIdx:null,idxs:null,event:null},mr={show:!0,stroke:`rgba(0,0,0,0.07)`,width:2},hr=H({},mr,{filter:zt}),gr=H({},hr,{size:10}),_r=H({},mr,{show:!1}),vr=`12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, "Noto Sans", sans-serif, "Apple Color Emoji", "Segoe UI Emoji", "Segoe UI Symbol", "Noto Color Emoji"`,yr=`bold `+vr,br=1.5,xr={show:!0,scale:`x`,stroke:A,space:50,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:yr,side:2,grid:hr,ticks:gr,border:_r,font:vr,lineGap:br,rotate:0},Sr=`Value`,Cr=`Time`,wr={show:!0,scale:`x`,auto:!1,sorted:1,min:I,max:-1/0,idxs:[]};function Tr(e,t,n,r,i){return t.map(e=>e==null?``:bt(e))}function Er(e,t,n,r,i,a,o){let s=[],c=Kt.get(i)||0;n=o?n:V(Wt(n,i),c);for(let e=n;e<=r;e=V(e+i,c))s.push(Object.is(e,-0)?0:e);return s}function Dr(e,t,n,r,i,a,o){let s=[],c=e.scales[e.axes[t].scale].log;i=kt(c,wt((c==10?jt:Mt)(n))),c==10&&(i=Nn[rt(i,Nn)]);let l=n,u=i*c;c==10&&(u=Nn[rt(u,Nn)]);do s.push(l),l+=i,c==10&&!Kt.has(l)&&(l=V(l,Kt.get(i))),l>=u&&(i=l,u=i*c,c==10&&(u=Nn[rt(u,Nn)]));while(l<=r);return s}function Or(e,t,n,r,i,a,o){let s=e.scales[e.axes[t].scale].asinh,c=r>s?Dr(e,t,Ot(s,n),r,i):[s],l=r>=0&&n<=0?[0]:[];return(n<-s?Dr(e,t,Ot(s,-r),-n,i):[s]).reverse().map(e=>-e).concat(l,c)}var kr=/./,Ar=/[12357]/,jr=/[125]/,Mr=/1/,Nr=(e,t,n,r)=>e.map((e,i)=>t==4&&e==0||i%r==0&&n.test(e.toExponential()[+(e<0)])?e:null);function Pr(e,t,n,r,i){let a=e.axes[n],o=a.scale,s=e.scales[o],c=e.valToPos,l=a._space,u=c(10,o),d=c(9,o)-u>=l?kr:c(7,o)-u>=l?Ar:c(5,o)-u>=l?jr:Mr;if(d==Mr){let e=Ct(c(1,o)-u);if(e<l)return Nr(t.slice().reverse(),s.distr,d,Et(l/e)).reverse()}return Nr(t,s.distr,d,1)}function Fr(e,t,n,r,i){let a=e.axes[n],o=a.scale,s=a._space,c=e.valToPos,l=Ct(c(1,o)-c(2,o));return l<s?Nr(t.slice().reverse(),3,kr,Et(s/l)).reverse():t}function Ir(e,t,n,r){return r==null?Re:t==null?``:bt(t)}var Lr={show:!0,scale:`y`,stroke:A,space:30,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:yr,side:3,grid:hr,ticks:gr,border:_r,font:vr,lineGap:br,rotate:0};function Rr(e,t){return V((3+(e||1)*2)*t,3)}function zr(e,t){let{scale:n,idxs:r}=e.series[0],i=e._data[0],a=e.valToPos(i[r[0]],n,!0),o=Ct(e.valToPos(i[r[1]],n,!0)-a)/(e.series[t].points.space*j);return r[1]-r[0]<=o}var Br={scale:null,auto:!0,sorted:0,min:I,max:-1/0},Vr=(e,t,n,r,i)=>i,Hr={show:!0,auto:!0,sorted:0,gaps:Vr,alpha:1,facets:[H({},Br,{scale:`x`}),H({},Br,{scale:`y`})]},Ur={scale:`y`,auto:!0,sorted:0,show:!0,spanGaps:!1,gaps:Vr,alpha:1,points:{show:zr,filter:null},values:null,min:I,max:-1/0,idxs:[],path:null,clip:null};function Wr(e,t,n,r,i){return n/10}var Gr={time:ee,auto:!0,distr:1,log:10,asinh:1,min:null,max:null,dir:1,ori:0},Kr=H({},Gr,{time:!1,ori:1}),qr={};function Jr(e,t){let n=qr[e];return n||(n={key:e,plots:[],sub(e){n.plots.push(e)},unsub(e){n.plots=n.plots.filter(t=>t!=e)},pub(e,t,r,i,a,o,s){for(let c=0;c<n.plots.length;c++)n.plots[c]!=t&&n.plots[c].pub(e,t,r,i,a,o,s)}},e!=null&&(qr[e]=n)),n}var Yr=1,Xr=2;function Zr(e,t,n){let r=e.mode,i=e.series[t],a=r==2?e._data[t]:e._data,o=e.scales,s=e.bbox,c=a[0],l=r==2?a[1]:a[t],u=r==2?o[i.facets[0].scale]:o[e.series[0].scale],d=r==2?o[i.facets[1].scale]:o[i.scale],f=s.left,p=s.top,m=s.width,h=s.height,g=e.valToPosH,_=e.valToPosV;return u.ori==0?n(i,c,l,u,d,g,_,f,p,m,h,oi,ci,ui,fi,mi):n(i,c,l,u,d,_,g,p,f,h,m,si,li,di,pi,hi)}function Qr(e,t){let n=0,r=0,i=F(e.bands,Xt);for(let e=0;e<i.length;e++){let a=i[e];a.series[0]==t?n=a.dir:a.series[1]==t&&(a.dir==1?r|=1:r|=2)}return[n,r==1?-1:r==2?1:r==3?2:0]}function $r(e,t,n,r,i){let a=e.mode,o=e.series[t],s=a==2?o.facets[1].scale:o.scale,c=e.scales[s];return i==-1?c.min:i==1?c.max:c.distr==3?c.dir==1?c.min:c.max:0}function ei(e,t,n,r,i,a){return Zr(e,t,(e,t,o,s,c,l,u,d,f,p,m)=>{let h=e.pxRound,g=s.dir*(s.ori==0?1:-1),_=s.ori==0?ci:li,v,y;g==1?(v=n,y=r):(v=r,y=n);let b=h(l(t[v],s,p,d)),x=h(u(o[v],c,m,f)),S=h(l(t[y],s,p,d)),C=h(u(a==1?c.max:c.min,c,m,f)),w=new Path2D(i);return _(w,S,C),_(w,b,C),_(w,b,x),w})}function ti(e,t,n,r,i,a){let o=null;if(e.length>0){o=new Path2D;let s=t==0?ui:di,c=n;for(let t=0;t<e.length;t++){let n=e[t];if(n[1]>n[0]){let e=n[0]-c;e>0&&s(o,c,r,e,r+a),c=n[1]}}let l=n+i-c;l>0&&s(o,c,r-5,l,r+a+10)}return o}function ni(e,t,n){let r=e[e.length-1];r&&r[0]==t?r[1]=n:e.push([t,n])}function ri(e,t,n,r,i,a,o){let s=[],c=e.length;for(let l=i==1?n:r;l>=n&&l<=r;l+=i)if(t[l]===null){let u=l,d=l;if(i==1)for(;++l<=r&&t[l]===null;)d=l;else for(;--l>=n&&t[l]===null;)d=l;let f=a(e[u]),p=d==u?f:a(e[d]),m=u-i;f=o<=0&&m>=0&&m<c?a(e[m]):f;let h=d+i;p=o>=0&&h>=0&&h<c?a(e[h]):p,p>=f&&s.push([f,p])}return s}function ii(e){return e==0?R:e==1?Tt:t=>Ut(t,e)}function ai(e){let t=e==0?oi:si,n=e==0?(e,t,n,r,i,a)=>{e.arcTo(t,n,r,i,a)}:(e,t,n,r,i,a)=>{e.arcTo(n,t,i,r,a)},r=e==0?(e,t,n,r,i)=>{e.rect(t,n,r,i)}:(e,t,n,r,i)=>{e.rect(n,t,i,r)};return(e,i,a,o,s,c=0,l=0)=>{c==0&&l==0?r(e,i,a,o,s):(c=Dt(c,o/2,s/2),l=Dt(l,o/2,s/2),t(e,i+c,a),n(e,i+o,a,i+o,a+s,c),n(e,i+o,a+s,i,a+s,l),n(e,i,a+s,i,a,l),n(e,i,a,i+o,a,c),e.closePath())}}var oi=(e,t,n)=>{e.moveTo(t,n)},si=(e,t,n)=>{e.moveTo(n,t)},ci=(e,t,n)=>{e.lineTo(t,n)},li=(e,t,n)=>{e.lineTo(n,t)},ui=ai(0),di=ai(1),fi=(e,t,n,r,i,a)=>{e.arc(t,n,r,i,a)},pi=(e,t,n,r,i,a)=>{e.arc(n,t,r,i,a)},mi=(e,t,n,r,i,a,o)=>{e.bezierCurveTo(t,n,r,i,a,o)},hi=(e,t,n,r,i,a,o)=>{e.bezierCurveTo(n,t,i,r,o,a)};function gi(e){return(e,t,n,r,i)=>Zr(e,t,(t,a,o,s,c,l,u,d,f,p,m)=>{let{pxRound:h,points:g}=t,_,v;s.ori==0?(_=oi,v=fi):(_=si,v=pi);let y=V(g.width*j,3),b=(g.size-g.width)/2*j,x=V(b*2,3),S=new Path2D,C=new Path2D,{left:w,top:T,width:E,height:D}=e.bbox;ui(C,w-x,T-x,E+x*2,D+x*2);let O=e=>{if(o[e]!=null){let t=h(l(a[e],s,p,d)),n=h(u(o[e],c,m,f));_(S,t+b,n),v(S,t,n,b,0,St*2)}};if(i)i.forEach(O);else for(let e=n;e<=r;e++)O(e);return{stroke:y>0?S:null,fill:S,clip:C,flags:3}})}function _i(e){return(t,n,r,i,a,o)=>{r!=i&&(a!=r&&o!=r&&e(t,n,r),a!=i&&o!=i&&e(t,n,i),e(t,n,o))}}var vi=_i(ci),yi=_i(li);function bi(e){let t=F(e?.alignGaps,0);return(e,n,r,i)=>Zr(e,n,(a,o,s,c,l,u,d,f,p,m,h)=>{[r,i]=st(s,r,i);let g=a.pxRound,_=e=>g(u(e,c,m,f)),v=e=>g(d(e,l,h,p)),y,b;c.ori==0?(y=ci,b=vi):(y=li,b=yi);let x=c.dir*(c.ori==0?1:-1),S={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Yr},C=S.stroke,w=!1;if(i-r>=m*4){let t=t=>e.posToVal(t,c.key,!0),n=null,a=null,l,u,d,f=_(o[x==1?r:i]),p=_(o[r]),m=_(o[i]),h=t(x==1?p+1:m-1);for(let e=x==1?r:i;e>=r&&e<=i;e+=x){let r=o[e],i=(x==1?r<h:r>h)?f:_(r),c=s[e];i==f?c==null?c===null&&(w=!0):(u=c,n==null?(y(C,i,v(u)),l=n=a=u):u<n?n=u:u>a&&(a=u)):(n!=null&&b(C,f,v(n),v(a),v(l),v(u)),c==null?(n=a=null,c===null&&(w=!0)):(u=c,y(C,i,v(u)),n=a=l=u),f=i,h=t(f+x))}n!=null&&n!=a&&d!=f&&b(C,f,v(n),v(a),v(l),v(u))}else for(let e=x==1?r:i;e>=r&&e<=i;e+=x){let t=s[e];t===null?w=!0:t!=null&&y(C,_(o[e]),v(t))}let[T,E]=Qr(e,n);if(a.fill!=null||T!=0){let t=S.fill=new Path2D(C),s=v(a.fillTo(e,n,a.min,a.max,T)),c=_(o[r]),l=_(o[i]);x==-1&&([l,c]=[c,l]),y(t,l,s),y(t,c,s)}if(!a.spanGaps){let l=[];w&&l.push(...ri(o,s,r,i,x,_,t)),S.gaps=l=a.gaps(e,n,r,i,l),S.clip=ti(l,c.ori,f,p,m,h)}return E!=0&&(S.band=E==2?[ei(e,n,r,i,C,-1),ei(e,n,r,i,C,1)]:ei(e,n,r,i,C,E)),S})}function xi(e){let t=F(e.align,1),n=F(e.ascDesc,!1),r=F(e.alignGaps,0),i=F(e.extend,!1);return(e,a,o,s)=>Zr(e,a,(c,l,u,d,f,p,m,h,g,_,v)=>{[o,s]=st(u,o,s);let y=c.pxRound,{left:b,width:x}=e.bbox,S=e=>y(p(e,d,_,h)),C=e=>y(m(e,f,v,g)),w=d.ori==0?ci:li,T={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Yr},E=T.stroke,D=d.dir*(d.ori==0?1:-1),O=C(u[D==1?o:s]),k=S(l[D==1?o:s]),ee=k,te=k;i&&t==-1&&(te=b,w(E,te,O)),w(E,k,O);for(let e=D==1?o:s;e>=o&&e<=s;e+=D){let n=u[e];if(n==null)continue;let r=S(l[e]),i=C(n);t==1?w(E,r,O):w(E,ee,i),w(E,r,i),O=i,ee=r}let ne=ee;i&&t==1&&(ne=b+x,w(E,ne,O));let[re,ie]=Qr(e,a);if(c.fill!=null||re!=0){let t=T.fill=new Path2D(E),n=C(c.fillTo(e,a,c.min,c.max,re));w(t,ne,n),w(t,te,n)}if(!c.spanGaps){let i=[];i.push(...ri(l,u,o,s,D,S,r));let f=c.width*j/2,p=n||t==1?f:-f,m=n||t==-1?-f:f;i.forEach(e=>{e[0]+=p,e[1]+=m}),T.gaps=i=c.gaps(e,a,o,s,i),T.clip=ti(i,d.ori,h,g,_,v)}return ie!=0&&(T.band=ie==2?[ei(e,a,o,s,E,-1),ei(e,a,o,s,E,1)]:ei(e,a,o,s,E,ie)),T})}function Si(e,t,n,r,i,a,o=I){if(e.length>1){let s=null;for(let c=0,l=1/0;c<e.length;c++)if(t[c]!==void 0){if(s!=null){let t=Ct(e[c]-e[s]);t<l&&(l=t,o=Ct(n(e[c],r,i,a)-n(e[s],r,i,a)))}s=c}}return o}function Ci(e){e||=Yt;let t=F(e.size,[.6,I,1]),n=e.align||0,r=e.gap||0,i=e.radius;i=i==null?[0,0]:typeof i==`number`?[i,0]:i;let a=L(i),o=1-t[0],s=F(t[1],I),c=F(t[2],1),l=F(e.disp,Yt),u=F(e.each,e=>{}),{fill:d,stroke:f}=l;return(e,t,i,p)=>Zr(e,t,(m,h,g,_,v,y,b,x,S,C,w)=>{let T=m.pxRound,E=n,D=r*j,O=s*j,k=c*j,ee,te;_.ori==0?[ee,te]=a(e,t):[te,ee]=a(e,t);let ne=_.dir*(_.ori==0?1:-1),re=_.ori==0?ui:di,ie=_.ori==0?u:(e,t,n,r,i,a,o)=>{u(e,t,n,i,r,o,a)},ae=F(e.bands,Xt).find(e=>e.series[0]==t),oe=ae==null?0:ae.dir,se=m.fillTo(e,t,m.min,m.max,oe),ce=T(b(se,v,w,S)),le,ue,de,fe=C,pe=T(m.width*j),me=!1,he=null,ge=null,_e=null,ve=null;d!=null&&(pe==0||f!=null)&&(me=!0,he=d.values(e,t,i,p),ge=new Map,new Set(he).forEach(e=>{e!=null&&ge.set(e,new Path2D)}),pe>0&&(_e=f.values(e,t,i,p),ve=new Map,new Set(_e).forEach(e=>{e!=null&&ve.set(e,new Path2D)})));let{x0:ye,size:be}=l;if(ye!=null&&be!=null){E=1,h=ye.values(e,t,i,p),ye.unit==2&&(h=h.map(t=>e.posToVal(x+t*C,_.key,!0)));let n=be.values(e,t,i,p);ue=be.unit==2?n[0]*C:y(n[0],_,C,x)-y(0,_,C,x),fe=Si(h,g,y,_,C,x,fe),de=fe-ue+D}else fe=Si(h,g,y,_,C,x,fe),de=fe*o+D,ue=fe-de;de<1&&(de=0),pe>=ue/2&&(pe=0),de<5&&(T=R);let xe=de>0,Se=fe-de-(xe?pe:0);ue=T(It(Se,k,O)),le=(E==0?ue/2:E==ne?0:ue)-E*ne*((E==0?D/2:0)+(xe?pe/2:0));let Ce={stroke:null,fill:null,clip:null,band:null,gaps:null,flags:0},we=me?null:new Path2D,Te=null;if(ae!=null)Te=e.data[ae.series[1]];else{let{y0:n,y1:r}=l;n!=null&&r!=null&&(g=r.values(e,t,i,p),Te=n.values(e,t,i,p))}let Ee=ee*ue,A=te*ue;for(let n=ne==1?i:p;n>=i&&n<=p;n+=ne){let r=g[n];if(r==null)continue;if(Te!=null){let e=Te[n]??0;if(r-e==0)continue;ce=b(e,v,w,S)}let i=y(_.distr!=2||l!=null?h[n]:n,_,C,x),a=b(F(r,se),v,w,S),o=T(i-le),s=T(Ot(a,ce)),c=T(Dt(a,ce)),u=s-c;if(r!=null){let i=r<0?A:Ee,a=r<0?Ee:A;me?(pe>0&&_e[n]!=null&&re(ve.get(_e[n]),o,c+wt(pe/2),ue,Ot(0,u-pe),i,a),he[n]!=null&&re(ge.get(he[n]),o,c+wt(pe/2),ue,Ot(0,u-pe),i,a)):re(we,o,c+wt(pe/2),ue,Ot(0,u-pe),i,a),ie(e,t,n,o-pe/2,c,ue+pe,u)}}return pe>0?Ce.stroke=me?ve:we:me||(Ce._fill=m.width==0?m._fill:m._stroke??m._fill,Ce.width=0),Ce.fill=me?ge:we,Ce})}function wi(e,t){let n=F(t?.alignGaps,0);return(t,r,i,a)=>Zr(t,r,(o,s,c,l,u,d,f,p,m,h,g)=>{[i,a]=st(c,i,a);let _=o.pxRound,v=e=>_(d(e,l,h,p)),y=e=>_(f(e,u,g,m)),b,x,S;l.ori==0?(b=oi,S=ci,x=mi):(b=si,S=li,x=hi);let C=l.dir*(l.ori==0?1:-1),w=v(s[C==1?i:a]),T=w,E=[],D=[];for(let e=C==1?i:a;e>=i&&e<=a;e+=C)if(c[e]!=null){let t=s[e],n=v(t);E.push(T=n),D.push(y(c[e]))}let O={stroke:e(E,D,b,S,x,_),fill:null,clip:null,band:null,gaps:null,flags:Yr},k=O.stroke,[ee,te]=Qr(t,r);if(o.fill!=null||ee!=0){let e=O.fill=new Path2D(k),n=y(o.fillTo(t,r,o.min,o.max,ee));S(e,T,n),S(e,w,n)}if(!o.spanGaps){let e=[];e.push(...ri(s,c,i,a,C,v,n)),O.gaps=e=o.gaps(t,r,i,a,e),O.clip=ti(e,l.ori,p,m,h,g)}return te!=0&&(O.band=te==2?[ei(t,r,i,a,k,-1),ei(t,r,i,a,k,1)]:ei(t,r,i,a,k,te)),O})}function K(e){return wi(q,e)}function q(e,t,n,r,i,a){let o=e.length;if(o<2)return null;let s=new Path2D;if(n(s,e[0],t[0]),o==2)r(s,e[1],t[1]);else{let n=Array(o),r=Array(o-1),a=Array(o-1),c=Array(o-1);for(let n=0;n<o-1;n++)a[n]=t[n+1]-t[n],c[n]=e[n+1]-e[n],r[n]=a[n]/c[n];n[0]=r[0];for(let e=1;e<o-1;e++)r[e]===0||r[e-1]===0||r[e-1]>0!=r[e]>0?n[e]=0:(n[e]=3*(c[e-1]+c[e])/((2*c[e]+c[e-1])/r[e-1]+(c[e]+2*c[e-1])/r[e]),isFinite(n[e])||(n[e]=0));n[o-1]=r[o-2];for(let r=0;r<o-1;r++)i(s,e[r]+c[r]/3,t[r]+n[r]*c[r]/3,e[r+1]-c[r]/3,t[r+1]-n[r+1]*c[r]/3,e[r+1],t[r+1])}return s}var Ti=new Set;function Ei(){for(let e of Ti)e.syncRect(!0)}ze&&(tt(Pe,Ve,Ei),tt(Fe,Ve,Ei,!0),tt(Le,Ve,()=>{J.pxRatio=j}));var Di=bi(),Oi=gi();function ki(e,t,n,r){return(r?[e[0],e[1]].concat(e.slice(2)):[e[0]].concat(e.slice(1))).map((e,r)=>ji(e,r,t,n))}function Ai(e,t){return e.map((e,n)=>n==0?{}:H({},t,e))}function ji(e,t,n,r){return H({},t==0?n:r,e)}function Mi(e,t,n){return t==null?Zt:[t,n]}var Ni=Mi;function Pi(e,t,n){return t==null?Zt:gt(t,n,ft,!0)}function Fi(e,t,n,r){return t==null?Zt:ut(t,n,e.scales[r].log,!1)}var Ii=Fi;function Li(e,t,n,r){return t==null?Zt:dt(t,n,e.scales[r].log,!1)}var Ri=Li;function zi(e,t,n,r,i){let a=Ot(Ft(e),Ft(t)),o=t-e,s=rt(i/r*o,n);do{let e=n[s],t=r*e/o;if(t>=i&&a+(e<5?Kt.get(e):0)<=17)return[e,t]}while(++s<n.length);return[0,0]}function Bi(e){let t,n;return e=e.replace(/(\d+)px/,(e,r)=>(t=Tt((n=+r)*j))+`px`),[e,t,n]}function Vi(e){e.show&&[e.font,e.labelFont].forEach(e=>{let t=V(e[2]*j,1);e[0]=e[0].replace(/[0-9.]+px/,t+`px`),e[1]=t})}function J(e,t,n){let r={mode:F(e.mode,1)},i=r.mode;function a(e,t,n,r){let i=t.valToPct(e);return r+n*(t.dir==-1?1-i:i)}function o(e,t,n,r){let i=t.valToPct(e);return r+n*(t.dir==-1?i:1-i)}function s(e,t,n,r){return t.ori==0?a(e,t,n,r):o(e,t,n,r)}r.valToPosH=a,r.valToPosV=o;let c=!1;r.status=0;let l=r.root=qe(te);if(e.id!=null&&(l.id=e.id),We(l,e.class),e.title){let t=qe(ie,l);t.textContent=e.title}let u=Ke(`canvas`),d=r.ctx=u.getContext(`2d`),f=qe(ae,l);tt(`click`,f,e=>{e.target===m&&(K!=xi||q!=Si)&&J.click(r,e)},!0);let p=r.under=qe(oe,f);f.appendChild(u);let m=r.over=qe(se,f);e=sn(e);let h=+F(e.pxAlign,1),g=ii(h);(e.plugins||[]).forEach(t=>{t.opts&&(e=t.opts(r,e)||e)});let _=e.ms||.001,v=r.series=i==1?ki(e.series||[],wr,Ur,!1):Ai(e.series||[null],Hr),y=r.axes=ki(e.axes||[],xr,Lr,!0),b=r.scales={},x=r.bands=e.bands||[];x.forEach(e=>{e.fill=L(e.fill||null),e.dir=F(e.dir,-1)});let S=i==2?v[1].facets[0].scale:v[0].scale,C={axes:ai,series:Nr},w=(e.drawOrder||[`axes`,`series`]).map(e=>C[e]);function T(e){let t=e.distr==3?t=>jt(t>0?t:e.clamp(r,t,e.min,e.max,e.key)):e.distr==4?t=>Pt(t,e.asinh):e.distr==100?t=>e.fwd(t):e=>e;return n=>{let r=t(n),{_min:i,_max:a}=e,o=a-i;return(r-i)/o}}function E(t){let n=b[t];if(n==null){let r=(e.scales||Yt)[t]||Yt;if(r.from!=null){E(r.from);let e=H({},b[r.from],r,{key:t});e.valToPct=T(e),b[t]=e}else{n=b[t]=H({},t==S?Gr:Kr,r),n.key=t;let e=n.time,a=n.range,o=Qt(a);if((t!=S||i==2&&!e)&&(o&&(a[0]==null||a[1]==null)&&(a={min:a[0]==null?pt:{mode:1,hard:a[0],soft:a[0]},max:a[1]==null?pt:{mode:1,hard:a[1],soft:a[1]}},o=!1),!o&&nn(a))){let e=a;a=(t,n,r)=>n==null?Zt:gt(n,r,e)}n.range=L(a||(e?Ni:t==S?n.distr==3?Ii:n.distr==4?Ri:Mi:n.distr==3?Fi:n.distr==4?Li:Pi)),n.auto=L(!o&&n.auto),n.clamp=L(n.clamp||Wr),n._min=n._max=null,n.valToPct=T(n)}}}E(`x`),E(`y`),i==1&&v.forEach(e=>{E(e.scale)}),y.forEach(e=>{E(e.scale)});for(let t in e.scales)E(t);let D=b[S],O=D.distr,k,ee;D.ori==0?(We(l,ne),k=a,ee=o):(We(l,re),k=o,ee=a);let A={};for(let e in b){let t=b[e];(t.min!=null||t.max!=null)&&(A[e]={min:t.min,max:t.max},t.min=t.max=null)}let Pe=e.tzDate||(e=>new Date(Tt(e/_))),Fe=e.fmtDate||Tn,Ie=_==1?Kn(Pe):Yn(Pe),ze=Zn(Pe,Xn(_==1?Gn:Jn,Fe)),He=tr(Pe,$n(er,Fe)),Ue=[],M=r.legend=H({},ir,e.legend),P=r.cursor=H({},pr,{drag:{y:i==2}},e.cursor),Ye=M.show,Ze=P.show,$e=M.markers;M.idxs=Ue,$e.width=L($e.width),$e.dash=L($e.dash),$e.stroke=L($e.stroke),$e.fill=L($e.fill);let et,it,at,ot=[],st=[],ct,mt=!1,ht={};if(M.live){let e=v[1]?v[1].values:null;mt=e!=null,ct=mt?e(r,1,0):{_:0};for(let e in ct)ht[e]=Re}if(Ye){if(et=Ke(`table`,me,l),at=Ke(`tbody`,null,et),M.mount(r,et),mt){it=Ke(`thead`,null,et,at);let e=Ke(`tr`,null,it);for(var vt in Ke(`th`,null,e),ct)Ke(`th`,ye,e).textContent=vt}else We(et,ge),M.live&&We(et,he)}let yt={show:!0},bt={show:!1};function xt(e,t){if(t==0&&(mt||!M.live||i==2))return Zt;let n=[],a=Ke(`tr`,_e,at,at.childNodes[t]);We(a,e.class),e.show||We(a,le);let o=Ke(`th`,null,a);if($e.show){let e=qe(ve,o);if(t>0){let n=$e.width(r,t);n&&(e.style.border=n+`px `+$e.dash(r,t)+` `+$e.stroke(r,t)),e.style.background=$e.fill(r,t)}}let s=qe(ye,o);for(var c in e.label instanceof HTMLElement?s.appendChild(e.label):s.textContent=e.label,t>0&&($e.show||(s.style.color=e.width>0?$e.stroke(r,t):$e.fill(r,t)),At(`click`,o,t=>{if(P._lock)return;wn(t);let n=v.indexOf(e);if((t.ctrlKey||t.metaKey)!=M.isolate){let e=v.some((e,t)=>t>0&&t!=n&&e.show);v.forEach((t,r)=>{r>0&&qi(r,e?r==n?yt:bt:yt,!0,Z.setSeries)})}else qi(n,{show:!e.show},!0,Z.setSeries)},!1),On&&At(je,o,t=>{P._lock||(wn(t),qi(v.indexOf(e),ta,!0,Z.setSeries))},!1)),ct){let e=Ke(`td`,be,a);e.textContent=`--`,n.push(e)}return[a,n]}let wt=new Map;function At(e,t,n,i=!0){let a=wt.get(t)||{},o=P.bind[e](r,t,n,i);o&&(tt(e,t,a[e]=o),wt.set(t,a))}function Mt(e,t,n){let r=wt.get(t)||{};for(let n in r)(e==null||n==e)&&(nt(n,t,r[n]),delete r[n]);e??wt.delete(t)}let Ft=0,Rt=0,R=0,z=0,B=0,Wt=0,Gt=B,Jt=Wt,$t=R,an=z,on=0,cn=0,ln=0,un=0;r.bbox={};let dn=!1,fn=!1,mn=!1,hn=!1,gn=!1,_n=!1;function vn(e,t,n){(n||e!=r.width||t!=r.height)&&yn(e,t),oi(!1),mn=!0,fn=!0,di()}function yn(e,t){r.width=Ft=R=e,r.height=Rt=z=t,B=Wt=0,Sn(),Cn();let n=r.bbox;on=n.left=Ut(B*j,.5),cn=n.top=Ut(Wt*j,.5),ln=n.width=Ut(R*j,.5),un=n.height=Ut(z*j,.5)}function bn(){let e=!1,t=0;for(;!e;){t++;let n=ni(t),i=ri(t);e=t==3||n&&i,e||(yn(r.width,r.height),fn=!0)}}function xn({width:e,height:t}){vn(e,t)}r.setSize=xn;function Sn(){let e=!1,t=!1,n=!1,r=!1;y.forEach((i,a)=>{if(i.show&&i._show){let{side:a,_size:o}=i,s=a%2,c=o+(i.label==null?0:i.labelSize);c>0&&(s?(R-=c,a==3?(B+=c,r=!0):n=!0):(z-=c,a==0?(Wt+=c,e=!0):t=!0))}}),zn[0]=e,zn[1]=n,zn[2]=t,zn[3]=r,R-=Un[1]+Un[3],B+=Un[3],z-=Un[2]+Un[0],Wt+=Un[0]}function Cn(){let e=B+R,t=Wt+z,n=B,r=Wt;function i(i,a){switch(i){case 1:return e+=a,e-a;case 2:return t+=a,t-a;case 3:return n-=a,n+a;case 0:return r-=a,r+a}}y.forEach((e,t)=>{if(e.show&&e._show){let t=e.side;e._pos=i(t,e._size),e.label!=null&&(e._lpos=i(t,e.labelSize))}})}if(P.dataIdx==null){let e=P.hover,n=e.skip=new Set(e.skip??[]);n.add(void 0);let r=e.prox=L(e.prox),i=e.bias??=0;P.dataIdx=(e,a,o,s)=>{if(a==0)return o;let c=o,l=r(e,a,o,s)??I,u=l>=0&&l<I,d=D.ori==0?R:z,f=P.left,p=t[0],m=t[a];if(n.has(m[o])){c=null;let e=null,t=null,r;if(i==0||i==-1)for(r=o;e==null&&r-->0;)n.has(m[r])||(e=r);if(i==0||i==1)for(r=o;t==null&&r++<m.length;)n.has(m[r])||(t=r);if(e!=null||t!=null){if(u){let n=e==null?-1/0:k(p[e],D,d,0),r=t==null?1/0:k(p[t],D,d,0),i=f-n,a=r-f;i<=a?i<=l&&(c=e):a<=l&&(c=t)}else c=t==null?e:e==null?t:o-e<=t-o?e:t}}else u&&Ct(f-k(p[o],D,d,0))>l&&(c=null);return c}}let wn=e=>{P.event=e};P.idxs=Ue,P._lock=!1;let En=P.points;En.show=L(En.show),En.size=L(En.size),En.stroke=L(En.stroke),En.width=L(En.width),En.fill=L(En.fill);let Dn=r.focus=H({},e.focus||{alpha:.3},P.focus),On=Dn.prox>=0,kn=On&&En.one,An=[],jn=[],Pn=[];function Fn(e,t){let n=En.show(r,t);if(n instanceof HTMLElement)return We(n,pe),We(n,e.class),Je(n,-10,-10,R,z),m.insertBefore(n,An[t]),n}function In(e,t){if(i==1||t>0){let t=i==1&&b[e.scale].time,n=e.value;e.value=t?tn(n)?tr(Pe,$n(n,Fe)):n||He:n||Ir,e.label=e.label||(t?Cr:Sr)}if(kn||t>0){e.width=e.width==null?1:e.width,e.paths=e.paths||Di||Bt,e.fillTo=L(e.fillTo||$r),e.pxAlign=+F(e.pxAlign,h),e.pxRound=ii(e.pxAlign),e.stroke=L(e.stroke||null),e.fill=L(e.fill||null),e._stroke=e._fill=e._paths=e._focus=null;let t=Rr(Ot(1,e.width),1),n=e.points=H({},{size:t,width:Ot(1,t*.2),stroke:e.stroke,space:t*2,paths:Oi,_stroke:null,_fill:null},e.points);n.show=L(n.show),n.filter=L(n.filter),n.fill=L(n.fill),n.stroke=L(n.stroke),n.paths=L(n.paths),n.pxAlign=e.pxAlign}if(Ye){let n=xt(e,t);ot.splice(t,0,n[0]),st.splice(t,0,n[1]),M.values.push(null)}if(Ze){Ue.splice(t,0,null);let n=null;kn?t==0&&(n=Fn(e,t)):t>0&&(n=Fn(e,t)),An.splice(t,0,n),jn.splice(t,0,0),Pn.splice(t,0,0)}Aa(`addSeries`,t)}function Ln(e,t){t??=v.length,e=i==1?ji(e,t,wr,Ur):ji(e,t,{},Hr),v.splice(t,0,e),In(v[t],t)}r.addSeries=Ln;function Rn(e){if(v.splice(e,1),Ye){M.values.splice(e,1),st.splice(e,1);let t=ot.splice(e,1)[0];Mt(null,t.firstChild),t.remove()}Ze&&(Ue.splice(e,1),An.splice(e,1)[0].remove(),jn.splice(e,1),Pn.splice(e,1)),Aa(`delSeries`,e)}r.delSeries=Rn;let zn=[!1,!1,!1,!1];function Bn(e,t){if(e._show=e.show,e.show){let n=e.side%2,i=b[e.scale];i??=(e.scale=n?v[1].scale:S,b[e.scale]);let a=i.time;e.size=L(e.size),e.space=L(e.space),e.rotate=L(e.rotate),Qt(e.incrs)&&e.incrs.forEach(e=>{!Kt.has(e)&&Kt.set(e,qt(e))}),e.incrs=L(e.incrs||(i.distr==2?Mn:a?_==1?Wn:qn:Nn)),e.splits=L(e.splits||(a&&i.distr==1?Ie:i.distr==3?Dr:i.distr==4?Or:Er)),e.stroke=L(e.stroke),e.grid.stroke=L(e.grid.stroke),e.ticks.stroke=L(e.ticks.stroke),e.border.stroke=L(e.border.stroke);let o=e.values;e.values=Qt(o)&&!Qt(o[0])?L(o):a?Qt(o)?Zn(Pe,Xn(o,Fe)):tn(o)?Qn(Pe,o):o||ze:o||Tr,e.filter=L(e.filter||(i.distr>=3&&i.log==10?Pr:i.distr==3&&i.log==2?Fr:zt)),e.font=Bi(e.font),e.labelFont=Bi(e.labelFont),e._size=e.size(r,null,t,0),e._space=e._rotate=e._incrs=e._found=e._splits=e._values=null,e._size>0&&(zn[t]=!0,e._el=qe(ce,f))}}function Vn(e,t,n,r){let[i,a,o,s]=n,c=t%2,l=0;return c==0&&(s||a)&&(l=t==0&&!i||t==2&&!o?Tt(xr.size/3):0),c==1&&(i||o)&&(l=t==1&&!a||t==3&&!s?Tt(Lr.size/2):0),l}let Hn=r.padding=(e.padding||[Vn,Vn,Vn,Vn]).map(e=>L(F(e,Vn))),Un=r._padding=Hn.map((e,t)=>e(r,t,zn,0)),U,W=null,G=null,nr=i==1?v[0].idxs:null,rr=null,ar=!1;function or(e,n){if(t=e??[],r.data=r._data=t,i==2){U=0;for(let e=1;e<v.length;e++)U+=t[e][0].length}else{t.length==0&&(r.data=r._data=t=[[]]),rr=t[0],U=rr.length;let e=t;if(O==2){e=t.slice();let n=e[0]=Array(U);for(let e=0;e<U;e++)n[e]=e}r._data=t=e}if(oi(!0),Aa(`setData`),O==2&&(mn=!0),n!==!1){let e=D;e.auto(r,ar)?sr():Ki(S,e.min,e.max),hn||=P.left>=0,_n=!0,di()}}r.setData=or;function sr(){ar=!0;let e,n;i==1&&(U>0?(W=nr[0]=0,G=nr[1]=U-1,e=t[0][W],n=t[0][G],O==2?(e=W,n=G):e==n&&(O==3?[e,n]=ut(e,e,D.log,!1):O==4?[e,n]=dt(e,e,D.log,!1):D.time?n=e+Tt(86400/_):[e,n]=gt(e,n,ft,!0))):(W=nr[0]=e=null,G=nr[1]=n=null)),Ki(S,e,n)}let cr,lr,ur,dr,fr,mr,hr,gr,_r,vr;function yr(e,t,n,r,i,a){e??=De,n??=Xt,r??=`butt`,i??=De,a??=`round`,e!=cr&&(d.strokeStyle=cr=e),i!=lr&&(d.fillStyle=lr=i),t!=ur&&(d.lineWidth=ur=t),a!=fr&&(d.lineJoin=fr=a),r!=mr&&(d.lineCap=mr=r),n!=dr&&d.setLineDash(dr=n)}function br(e,t,n,r){t!=lr&&(d.fillStyle=lr=t),e!=hr&&(d.font=hr=e),n!=gr&&(d.textAlign=gr=n),r!=_r&&(d.textBaseline=_r=r)}function kr(e,t,n,i,a=0){if(i.length>0&&e.auto(r,ar)&&(t==null||t.min==null)){let t=F(W,0),r=F(G,i.length-1),o=n.min==null?lt(i,t,r,a,e.distr==3):[n.min,n.max];e.min=Dt(e.min,n.min=o[0]),e.max=Ot(e.max,n.max=o[1])}}let Ar={min:null,max:null};function jr(){for(let e in b){let t=b[e];A[e]==null&&(t.min==null||A[S]!=null&&t.auto(r,ar))&&(A[e]=Ar)}for(let e in b){let t=b[e];A[e]==null&&t.from!=null&&A[t.from]!=null&&(A[e]=Ar)}A[S]!=null&&oi(!0);let e={};for(let t in A){let n=A[t];if(n!=null){let a=e[t]=sn(b[t],rn);if(n.min!=null)H(a,n);else if(t!=S||i==2){if(U==0&&a.from==null){let e=a.range(r,null,null,t);a.min=e[0],a.max=e[1]}else a.min=I,a.max=-1/0}}}if(U>0){v.forEach((n,a)=>{if(i==1){let i=n.scale,o=A[i];if(o==null)return;let s=e[i];if(a==0){let e=s.range(r,s.min,s.max,i);s.min=e[0],s.max=e[1],W=rt(s.min,t[0]),G=rt(s.max,t[0]),G-W>1&&(t[0][W]<s.min&&W++,t[0][G]>s.max&&G--),n.min=rr[W],n.max=rr[G]}else n.show&&n.auto&&kr(s,o,n,t[a],n.sorted);n.idxs[0]=W,n.idxs[1]=G}else if(a>0&&n.show&&n.auto){let[r,i]=n.facets,o=r.scale,s=i.scale,[c,l]=t[a],u=e[o],d=e[s];u!=null&&kr(u,A[o],r,c,r.sorted),d!=null&&kr(d,A[s],i,l,i.sorted),n.min=i.min,n.max=i.max}});for(let t in e){let n=e[t],i=A[t];if(n.from==null&&(i==null||i.min==null)){let e=n.range(r,n.min==I?null:n.min,n.max==-1/0?null:n.max,t);n.min=e[0],n.max=e[1]}}}for(let t in e){let n=e[t];if(n.from!=null){let i=e[n.from];if(i.min==null)n.min=n.max=null;else{let e=n.range(r,i.min,i.max,t);n.min=e[0],n.max=e[1]}}}let n={},a=!1;for(let t in e){let r=e[t],i=b[t];if(i.min!=r.min||i.max!=r.max){i.min=r.min,i.max=r.max;let e=i.distr;i._min=e==3?jt(i.min):e==4?Pt(i.min,i.asinh):e==100?i.fwd(i.min):i.min,i._max=e==3?jt(i.max):e==4?Pt(i.max,i.asinh):e==100?i.fwd(i.max):i.max,n[t]=a=!0}}if(a){v.forEach((e,t)=>{i==2?t>0&&n.y&&(e._paths=null):n[e.scale]&&(e._paths=null)});for(let e in n)mn=!0,Aa(`setScale`,e);Ze&&P.left>=0&&(hn=_n=!0)}for(let e in A)A[e]=null}function Mr(e){let t=It(W-1,0,U-1),n=It(G+1,0,U-1);for(;e[t]==null&&t>0;)t--;for(;e[n]==null&&n<U-1;)n++;return[t,n]}function Nr(){if(U>0){let e=v.some(e=>e._focus)&&vr!=Dn.alpha;e&&(d.globalAlpha=vr=Dn.alpha),v.forEach((e,n)=>{if(n>0&&e.show&&(zr(n,!1),zr(n,!0),e._paths==null)){let a=vr;vr!=e.alpha&&(d.globalAlpha=vr=e.alpha);let o=i==2?[0,t[n][0].length-1]:Mr(t[n]);e._paths=e.paths(r,n,o[0],o[1]),vr!=a&&(d.globalAlpha=vr=a)}}),v.forEach((e,t)=>{if(t>0&&e.show){let n=vr;vr!=e.alpha&&(d.globalAlpha=vr=e.alpha),e._paths!=null&&Br(t,!1);{let n=e._paths==null?null:e._paths.gaps,i=e.points.show(r,t,W,G,n),a=e.points.filter(r,t,i,n);(i||a)&&(e.points._paths=e.points.paths(r,t,W,G,a),Br(t,!0))}vr!=n&&(d.globalAlpha=vr=n),Aa(`drawSeries`,t)}}),e&&(d.globalAlpha=vr=1)}}function zr(e,t){let n=t?v[e].points:v[e];n._stroke=n.stroke(r,e),n._fill=n.fill(r,e)}function Br(e,t){let n=t?v[e].points:v[e],{stroke:r,fill:i,clip:a,flags:o,_stroke:s=n._stroke,_fill:c=n._fill,_width:l=n.width}=n._paths;l=V(l*j,3);let u=null,f=l%2/2;t&&c==null&&(c=l>0?`#fff`:s);let p=n.pxAlign==1&&f>0;if(p&&d.translate(f,f),!t){let e=on-l/2,t=cn-l/2,n=ln+l,r=un+l;u=new Path2D,u.rect(e,t,n,r)}t?qr(s,l,n.dash,n.cap,c,r,i,o,a):Vr(e,s,l,n.dash,n.cap,c,r,i,o,u,a),p&&d.translate(-f,-f)}function Vr(e,n,i,a,o,s,c,l,u,d,f){let p=!1;u!=0&&x.forEach((m,h)=>{if(m.series[0]==e){let e=v[m.series[1]],g=t[m.series[1]],_=(e._paths||Yt).band;Qt(_)&&(_=m.dir==1?_[0]:_[1]);let y,b=null;e.show&&_&&_t(g,W,G)?(b=m.fill(r,h)||s,y=e._paths.clip):_=null,qr(n,i,a,o,b,c,l,u,d,f,y,_),p=!0}}),p||qr(n,i,a,o,s,c,l,u,d,f)}function qr(e,t,n,r,i,a,o,s,c,l,u,f){yr(e,t,n,r,i),(c||l||f)&&(d.save(),c&&d.clip(c),l&&d.clip(l)),f?(s&3)==3?(d.clip(f),u&&d.clip(u),Qr(i,o),Zr(e,a,t)):s&Xr?(Qr(i,o),d.clip(f),Zr(e,a,t)):s&Yr&&(d.save(),d.clip(f),u&&d.clip(u),Qr(i,o),d.restore(),Zr(e,a,t)):(Qr(i,o),Zr(e,a,t)),(c||l||f)&&d.restore()}function Zr(e,t,n){n>0&&(t instanceof Map?t.forEach((e,t)=>{d.strokeStyle=cr=t,d.stroke(e)}):t!=null&&e&&d.stroke(t))}function Qr(e,t){t instanceof Map?t.forEach((e,t)=>{d.fillStyle=lr=t,d.fill(e)}):t!=null&&e&&d.fill(t)}function ei(e,t,n,i){let a=y[e],o;if(i<=0)o=[0,0];else{let s=a._space=a.space(r,e,t,n,i);o=zi(t,n,a._incrs=a.incrs(r,e,t,n,i,s),i,s)}return a._found=o}function ti(e,t,n,r,i,a,o,s,c,l){let u=o%2/2;h==1&&d.translate(u,u),yr(s,o,c,l,s),d.beginPath();let f,p,m,g,_=i+(r==0||r==3?-a:a);n==0?(p=i,g=_):(f=i,m=_);for(let r=0;r<e.length;r++)t[r]!=null&&(n==0?f=m=e[r]:p=g=e[r],d.moveTo(f,p),d.lineTo(m,g));d.stroke(),h==1&&d.translate(-u,-u)}function ni(e){let t=!0;return y.forEach((n,i)=>{if(!n.show)return;let a=b[n.scale];if(a.min==null){n._show&&(t=!1,n._show=!1,oi(!1));return}n._show||(t=!1,n._show=!0,oi(!1));let o=n.side,s=o%2,{min:c,max:l}=a,[u,d]=ei(i,c,l,s==0?R:z);if(d==0)return;let f=a.distr==2,p=n._splits=n.splits(r,i,c,l,u,d,f),m=a.distr==2?p.map(e=>rr[e]):p,h=a.distr==2?rr[p[1]]-rr[p[0]]:u,g=n._values=n.values(r,n.filter(r,m,i,d,h),i,d,h);n._rotate=o==2?n.rotate(r,g,i,d):0;let _=n._size;n._size=Et(n.size(r,g,i,e)),_!=null&&n._size!=_&&(t=!1)}),t}function ri(e){let t=!0;return Hn.forEach((n,i)=>{let a=n(r,i,zn,e);a!=Un[i]&&(t=!1),Un[i]=a}),t}function ai(){for(let e=0;e<y.length;e++){let t=y[e];if(!t.show||!t._show)continue;let n=t.side,i=n%2,a,o,c=t.stroke(r,e),l=n==0||n==3?-1:1,[u,f]=t._found;if(t.label!=null){let s=t.labelGap*l,p=Tt((t._lpos+s)*j);br(t.labelFont[0],c,`center`,n==2?Ce:we),d.save(),i==1?(a=o=0,d.translate(p,Tt(cn+un/2)),d.rotate((n==3?-St:St)/2)):(a=Tt(on+ln/2),o=p);let m=Lt(t.label)?t.label(r,e,u,f):t.label;d.fillText(m,a,o),d.restore()}if(f==0)continue;let p=b[t.scale],m=i==0?ln:un,h=i==0?on:cn,_=t._splits,v=p.distr==2?_.map(e=>rr[e]):_,x=p.distr==2?rr[_[1]]-rr[_[0]]:u,S=t.ticks,C=t.border,w=S.show?S.size:0,T=Tt(w*j),E=Tt((t.alignTo==2?t._size-w-t.gap:t.gap)*j),D=t._rotate*-St/180,O=g(t._pos*j),k=O+(T+E)*l;o=i==0?k:0,a=i==1?k:0;let ee=t.font[0];br(ee,c,t.align==1?Te:t.align==2?Ee:D>0?Te:D<0?Ee:i==0?`center`:n==3?Ee:Te,D||i==1?`middle`:n==2?Ce:we);let te=t.font[1]*t.lineGap,ne=_.map(e=>g(s(e,p,m,h))),re=t._values;for(let e=0;e<re.length;e++){let t=re[e];if(t!=null){i==0?a=ne[e]:o=ne[e],t=``+t;let n=t.indexOf(`
`)==-1?[t]:t.split(/\n/gm);for(let e=0;e<n.length;e++){let t=n[e];D?(d.save(),d.translate(a,o+e*te),d.rotate(D),d.fillText(t,0,0),d.restore()):d.fillText(t,a,o+e*te)}}}S.show&&ti(ne,S.filter(r,v,e,f,x),i,n,O,T,V(S.width*j,3),S.stroke(r,e),S.dash,S.cap);let ie=t.grid;ie.show&&ti(ne,ie.filter(r,v,e,f,x),i,i==0?2:1,i==0?cn:on,i==0?un:ln,V(ie.width*j,3),ie.stroke(r,e),ie.dash,ie.cap),C.show&&ti([O],[1],+(i==0),i==0?1:2,i==1?cn:on,i==1?un:ln,V(C.width*j,3),C.stroke(r,e),C.dash,C.cap)}Aa(`drawAxes`)}function oi(e){v.forEach((t,n)=>{n>0&&(t._paths=null,e&&(i==1?(t.min=null,t.max=null):t.facets.forEach(e=>{e.min=null,e.max=null})))})}let si=!1,ci=!1,li=[];function ui(){ci=!1;for(let e=0;e<li.length;e++)Aa(...li[e]);li.length=0}function di(){si||=(pn(pi),!0)}function fi(e,t=!1){si=!0,ci=t,e(r),pi(),t&&li.length>0&&queueMicrotask(ui)}r.batch=fi;function pi(){if(dn&&=(jr(),!1),mn&&=(bn(),!1),fn){if(N(p,Te,B),N(p,Ce,Wt),N(p,xe,R),N(p,Se,z),N(m,Te,B),N(m,Ce,Wt),N(m,xe,R),N(m,Se,z),N(f,xe,Ft),N(f,Se,Rt),u.width=Tt(Ft*j),u.height=Tt(Rt*j),y.forEach(({_el:e,_show:t,_size:n,_pos:r,side:i})=>{if(e!=null){if(t){let t=i===3||i===0?n:0,a=i%2==1;N(e,a?`left`:`top`,r-t),N(e,a?`width`:`height`,n),N(e,a?`top`:`left`,a?Wt:B),N(e,a?`height`:`width`,a?z:R),Ge(e,le)}else We(e,le)}}),cr=lr=ur=fr=mr=hr=gr=_r=dr=null,vr=1,ma(!0),B!=Gt||Wt!=Jt||R!=$t||z!=an){oi(!1);let e=R/$t,t=z/an;if(Ze&&!hn&&P.left>=0){P.left*=e,P.top*=t,_i&&Je(_i,Tt(P.left),0,R,z),vi&&Je(vi,0,Tt(P.top),R,z);for(let n=0;n<An.length;n++){let r=An[n];r!=null&&(jn[n]*=e,Pn[n]*=t,Je(r,Et(jn[n]),Et(Pn[n]),R,z))}}if(X.show&&!gn&&X.left>=0&&X.width>0){X.left*=e,X.width*=e,X.top*=t,X.height*=t;for(let e in _a)N(Ui,e,X[e])}Gt=B,Jt=Wt,$t=R,an=z}Aa(`setSize`),fn=!1}Ft>0&&Rt>0&&(d.clearRect(0,0,u.width,u.height),Aa(`drawClear`),w.forEach(e=>e()),Aa(`draw`)),X.show&&gn&&(Wi(X),gn=!1),Ze&&hn&&(fa(null,!0,!1),hn=!1),M.show&&M.live&&_n&&(ua(),_n=!1),c||(c=!0,r.status=1,Aa(`ready`)),ar=!1,si=!1}r.redraw=(e,t)=>{mn=t||!1,e===!1?di():Ki(S,D.min,D.max)};function mi(e,n){let i=b[e];if(i.from==null){if(U==0){let t=i.range(r,n.min,n.max,e);n.min=t[0],n.max=t[1]}if(n.min>n.max){let e=n.min;n.min=n.max,n.max=e}if(U>1&&n.min!=null&&n.max!=null&&n.max-n.min<1e-16)return;e==S&&i.distr==2&&U>0&&(n.min=rt(n.min,t[0]),n.max=rt(n.max,t[0]),n.min==n.max&&n.max++),A[e]=n,dn=!0,di()}}r.setScale=mi;let hi,gi,_i,vi,yi,bi,xi,Si,Ci,wi,K,q,Ei=!1,J=P.drag,Y=J.x,Hi=J.y;Ze&&(P.x&&(hi=qe(de,m)),P.y&&(gi=qe(fe,m)),D.ori==0?(_i=hi,vi=gi):(_i=gi,vi=hi),K=P.left,q=P.top);let X=r.select=H({show:!0,over:!0,left:0,width:0,top:0,height:0},e.select),Ui=X.show?qe(ue,X.over?m:p):null;function Wi(e,t){if(X.show){for(let t in e)X[t]=e[t],t in _a&&N(Ui,t,e[t]);t!==!1&&Aa(`setSelect`)}}r.setSelect=Wi;function Gi(e){if(v[e].show)Ye&&Ge(ot[e],le);else if(Ye&&We(ot[e],le),Ze){let t=kn?An[0]:An[e];t!=null&&Je(t,-10,-10,R,z)}}function Ki(e,t,n){mi(e,{min:t,max:n})}function qi(e,t,n,a){t.focus!=null&&na(e),t.show!=null&&v.forEach((n,r)=>{r>0&&(e==r||e==null)&&(n.show=t.show,Gi(r),i==2?(Ki(n.facets[0].scale,null,null),Ki(n.facets[1].scale,null,null)):Ki(n.scale,null,null),di())}),n!==!1&&Aa(`setSeries`,e,t),a&&Pa(`setSeries`,r,e,t)}r.setSeries=qi;function Ji(e,t){H(x[e],t)}function Yi(e,t){e.fill=L(e.fill||null),e.dir=F(e.dir,-1),t??=x.length,x.splice(t,0,e)}function Xi(e){e==null?x.length=0:x.splice(e,1)}r.addBand=Yi,r.setBand=Ji,r.delBand=Xi;function Zi(e,t){v[e].alpha=t,Ze&&An[e]!=null&&(An[e].style.opacity=t),Ye&&ot[e]&&(ot[e].style.opacity=t)}let Qi,$i,ea,ta={focus:!0};function na(e){if(e!=ea){let t=e==null,n=Dn.alpha!=1;v.forEach((r,a)=>{if(i==1||a>0){let i=t||a==0||a==e;r._focus=t?null:i,n&&Zi(a,i?1:Dn.alpha)}}),ea=e,n&&di()}}Ye&&On&&At(Me,et,e=>{P._lock||(wn(e),ea!=null&&qi(null,ta,!0,Z.setSeries))});function ra(e,t,n){let r=b[t];n&&(e=e/j-(r.ori==1?Wt:B));let i=R;r.ori==1&&(i=z,e=i-e),r.dir==-1&&(e=i-e);let a=r._min,o=r._max,s=e/i,c=a+(o-a)*s,l=r.distr;return l==3?kt(10,c):l==4?Nt(c,r.asinh):l==100?r.bwd(c):c}function ia(e,n){return rt(ra(e,S,n),t[0],W,G)}r.valToIdx=e=>rt(e,t[0]),r.posToIdx=ia,r.posToVal=ra,r.valToPos=(e,t,n)=>b[t].ori==0?a(e,b[t],n?ln:R,n?on:0):o(e,b[t],n?un:z,n?cn:0),r.setCursor=(e,t,n)=>{K=e.left,q=e.top,fa(null,t,n)};function aa(e,t){N(Ui,Te,X.left=e),N(Ui,xe,X.width=t)}function oa(e,t){N(Ui,Ce,X.top=e),N(Ui,Se,X.height=t)}let sa=D.ori==0?aa:oa,ca=D.ori==1?aa:oa;function la(){if(Ye&&M.live)for(let e=+(i==2);e<v.length;e++){if(e==0&&mt)continue;let t=M.values[e],n=0;for(let r in t)st[e][n++].firstChild.nodeValue=t[r]}}function ua(e,t){if(e!=null&&(e.idxs?e.idxs.forEach((e,t)=>{Ue[t]=e}):en(e.idx)||Ue.fill(e.idx),M.idx=Ue[0]),Ye&&M.live){for(let e=0;e<v.length;e++)(e>0||i==1&&!mt)&&da(e,Ue[e]);la()}_n=!1,t!==!1&&Aa(`setLegend`)}r.setLegend=ua;function da(e,n){let i=v[e],a=e==0&&O==2?rr:t[e],o;mt?o=i.values(r,e,n)??ht:(o=i.value(r,n==null?null:a[n],e,n),o=o==null?ht:{_:o}),M.values[e]=o}function fa(e,n,a){Ci=K,wi=q,[K,q]=P.move(r,K,q),P.left=K,P.top=q,Ze&&(_i&&Je(_i,Tt(K),0,R,z),vi&&Je(vi,0,Tt(q),R,z));let o,s=W>G;Qi=I,$i=null;let c=D.ori==0?R:z,l=D.ori==1?R:z;if(K<0||U==0||s){o=P.idx=null;for(let e=0;e<v.length;e++){let t=An[e];t!=null&&Je(t,-10,-10,R,z)}On&&qi(null,ta,!0,e==null&&Z.setSeries),M.live&&(Ue.fill(o),_n=!0)}else{let e,n,a;i==1&&(e=D.ori==0?K:q,n=ra(e,S),o=P.idx=rt(n,t[0],W,G),a=k(t[0][o],D,c,0));let s=-10,u=-10,d=0,f=0,p=!0,m=``,h=``;for(let e=+(i==2);e<v.length;e++){let g=v[e],_=Ue[e],y=_==null?null:i==1?t[e][_]:t[e][1][_],x=P.dataIdx(r,e,o,n),S=x==null?null:i==1?t[e][x]:t[e][1][x];if(_n=_n||S!=y||x!=_,Ue[e]=x,e>0&&g.show){let n=x==null?-10:x==o?a:k(i==1?t[0][x]:t[e][0][x],D,c,0),_=S==null?-10:ee(S,i==1?b[g.scale]:b[g.facets[1].scale],l,0);if(On&&S!=null){let t=D.ori==1?K:q,n=Ct(Dn.dist(r,e,x,_,t));if(n<Qi){let r=Dn.bias;if(r!=0){let i=ra(t,g.scale),a=S>=0?1:-1,o=i>=0?1:-1;o==a&&(o==1?r==1?S>=i:S<=i:r==1?S<=i:S>=i)&&(Qi=n,$i=e)}else Qi=n,$i=e}}if(_n||kn){let t,i;D.ori==0?(t=n,i=_):(t=_,i=n);let a,o,c,l,g,v,y=!0,b=En.bbox;if(b!=null){y=!1;let t=b(r,e);c=t.left,l=t.top,a=t.width,o=t.height}else c=t,l=i,a=o=En.size(r,e);if(v=En.fill(r,e),g=En.stroke(r,e),kn)e==$i&&Qi<=Dn.prox&&(s=c,u=l,d=a,f=o,p=y,m=v,h=g);else{let t=An[e];t!=null&&(jn[e]=c,Pn[e]=l,Qe(t,a,o,y),Xe(t,v,g),Je(t,Et(c),Et(l),R,z))}}}}if(kn){let e=Dn.prox;if(_n||(ea==null?Qi<=e:Qi>e||$i!=ea)){let e=An[0];e!=null&&(jn[0]=s,Pn[0]=u,Qe(e,d,f,p),Xe(e,m,h),Je(e,Et(s),Et(u),R,z))}}}if(X.show&&Ei){if(e!=null){let[t,n]=Z.scales,[r,i]=Z.match,[a,o]=e.cursor.sync.scales,s=e.cursor.drag;if(Y=s._x,Hi=s._y,Y||Hi){let{left:s,top:u,width:d,height:f}=e.select,p=e.scales[a].ori,m=e.posToVal,h,g,_,v,y,x=t!=null&&r(t,a),S=n!=null&&i(n,o);x&&Y?(p==0?(h=s,g=d):(h=u,g=f),_=b[t],v=k(m(h,a),_,c,0),y=k(m(h+g,a),_,c,0),sa(Dt(v,y),Ct(y-v))):sa(0,c),S&&Hi?(p==1?(h=s,g=d):(h=u,g=f),_=b[n],v=ee(m(h,o),_,l,0),y=ee(m(h+g,o),_,l,0),ca(Dt(v,y),Ct(y-v))):ca(0,l)}else va()}else{let e=Ct(Ci-yi),t=Ct(wi-bi);if(D.ori==1){let n=e;e=t,t=n}Y=J.x&&e>=J.dist,Hi=J.y&&t>=J.dist;let n=J.uni;n==null?J.x&&J.y&&(Y||Hi)&&(Y=Hi=!0):Y&&Hi&&(Y=e>=n,Hi=t>=n,!Y&&!Hi&&(t>e?Hi=!0:Y=!0));let r,i;Y&&(D.ori==0?(r=xi,i=K):(r=Si,i=q),sa(Dt(r,i),Ct(i-r)),Hi||ca(0,l)),Hi&&(D.ori==1?(r=xi,i=K):(r=Si,i=q),ca(Dt(r,i),Ct(i-r)),Y||sa(0,c)),!Y&&!Hi&&(sa(0,0),ca(0,0))}}if(J._x=Y,J._y=Hi,e==null){if(a){if(Ma!=null){let[e,t]=Z.scales;Z.values[0]=e==null?null:ra(D.ori==0?K:q,e),Z.values[1]=t==null?null:ra(D.ori==1?K:q,t)}Pa(Oe,r,K,q,R,z,o)}if(On){let e=a&&Z.setSeries,t=Dn.prox;ea==null?Qi<=t&&qi($i,ta,!0,e):Qi>t?qi(null,ta,!0,e):$i!=ea&&qi($i,ta,!0,e)}}_n&&(M.idx=o,ua()),n!==!1&&Aa(`setCursor`)}let pa=null;Object.defineProperty(r,"rect",{get(){return pa??ma(!1),pa}});function ma(e=!1){e?pa=null:(pa=m.getBoundingClientRect(),Aa(`syncRect`,pa))}function ha(e,t,n,r,i,a,o){P._lock||Ei&&e!=null&&e.movementX==0&&e.movementY==0||(ga(e,t,n,r,i,a,o,!1,e!=null),e==null?fa(t,!0,!1):fa(null,!0,!0))}function ga(e,t,n,i,a,o,c,l,u){if(pa??ma(!1),wn(e),e!=null)n=e.clientX-pa.left,i=e.clientY-pa.top;else{if(n<0||i<0){K=-10,q=-10;return}let[e,r]=Z.scales,c=t.cursor.sync,[l,u]=c.values,[d,f]=c.scales,[p,m]=Z.match,h=t.axes[0].side%2==1,g=D.ori==0?R:z,_=D.ori==1?R:z,v=h?o:a,y=h?a:o,x=h?i:n,S=h?n:i;if(n=d==null?x/v*g:p(e,d)?s(l,b[e],g,0):-10,i=f==null?S/y*_:m(r,f)?s(u,b[r],_,0):-10,D.ori==1){let e=n;n=i,i=e}}u&&(t==null||t.cursor.event.type==Oe)&&((n<=1||n>=R-1)&&(n=Ut(n,R)),(i<=1||i>=z-1)&&(i=Ut(i,z))),l?(yi=n,bi=i,[xi,Si]=P.move(r,n,i)):(K=n,q=i)}let _a={width:0,height:0,left:0,top:0};function va(){Wi(_a,!1)}let ya,ba,xa,Sa;function Ca(e,t,n,i,a,o,s){Ei=!0,Y=Hi=J._x=J._y=!1,ga(e,t,n,i,a,o,s,!0,!1),e!=null&&(At(Ae,Be,wa,!1),Pa(ke,r,xi,Si,R,z,null));let{left:c,top:l,width:u,height:d}=X;ya=c,ba=l,xa=u,Sa=d}function wa(e,t,n,i,a,o,s){Ei=J._x=J._y=!1,ga(e,t,n,i,a,o,s,!1,!0);let{left:c,top:l,width:u,height:d}=X,f=u>0||d>0,p=ya!=c||ba!=l||xa!=u||Sa!=d;if(f&&p&&Wi(X),J.setScale&&f&&p){let e=c,t=u,n=l,r=d;if(D.ori==1&&(e=l,t=d,n=c,r=u),Y&&Ki(S,ra(e,S),ra(e+t,S)),Hi)for(let e in b){let t=b[e];e!=S&&t.from==null&&t.min!=I&&Ki(e,ra(n+r,e),ra(n,e))}va()}else P.lock&&(P._lock=!P._lock,fa(t,!0,e!=null));e!=null&&(Mt(Ae,Be),Pa(Ae,r,K,q,R,z,null))}function Ta(e,t,n,r,i,a,o){if(P._lock)return;wn(e);let s=Ei;if(Ei){let e=!0,t=!0,n,r;D.ori==0?(n=Y,r=Hi):(n=Hi,r=Y),n&&r&&(e=K<=10||K>=R-10,t=q<=10||q>=z-10),n&&e&&(K=K<xi?0:R),r&&t&&(q=q<Si?0:z),fa(null,!0,!0),Ei=!1}K=-10,q=-10,Ue.fill(null),fa(null,!0,!0),s&&(Ei=s)}function Ea(e,t,n,i,a,o,s){P._lock||(wn(e),sr(),va(),e!=null&&Pa(Ne,r,K,q,R,z,null))}function Da(){y.forEach(Vi),vn(r.width,r.height,!0)}tt(Le,Ve,Da);let Oa={};Oa.mousedown=Ca,Oa.mousemove=ha,Oa.mouseup=wa,Oa.dblclick=Ea,Oa.setSeries=(e,t,n,i)=>{let a=Z.match[2];n=a(r,t,n),n!=-1&&qi(n,i,!0,!1)},Ze&&(At(ke,m,Ca),At(Oe,m,ha),At(je,m,e=>{wn(e),ma(!1)}),At(Me,m,Ta),At(Ne,m,Ea),Ti.add(r),r.syncRect=ma);let ka=r.hooks=e.hooks||{};function Aa(e,t,n){ci?li.push([e,t,n]):e in ka&&ka[e].forEach(e=>{e.call(null,r,t,n)})}(e.plugins||[]).forEach(e=>{for(let t in e.hooks)ka[t]=(ka[t]||[]).concat(e.hooks[t])});let ja=(e,t,n)=>n,Z=H({key:null,setSeries:!1,filters:{pub:Vt,sub:Vt},scales:[S,v[1]?v[1].scale:null],match:[Ht,Ht,ja],values:[null,null]},P.sync);Z.match.length==2&&Z.match.push(ja),P.sync=Z;let Ma=Z.key,Na=Jr(Ma);function Pa(e,t,n,r,i,a,o){Z.filters.pub(e,t,n,r,i,a,o)&&Na.pub(e,t,n,r,i,a,o)}Na.sub(r);function Fa(e,t,n,r,i,a,o){Z.filters.sub(e,t,n,r,i,a,o)&&Oa[e](null,t,n,r,i,a,o)}r.pub=Fa;function Ia(){Na.unsub(r),Ti.delete(r),wt.clear(),nt(Le,Ve,Da),l.remove(),et?.remove(),Aa(`destroy`)}r.destroy=Ia;function La(){Aa(`init`,e,t),or(t||e.data,!1),A[S]?mi(S,A[S]):sr(),gn=X.show&&(X.width>0||X.height>0),hn=_n=!0,vn(e.width,e.height)}return v.forEach(In),y.forEach(Bn),n?n instanceof HTMLElement?(n.appendChild(l),La()):n(r,La):La(),r}J.assign=H,J.fmtNum=bt,J.rangeNum=gt,J.rangeLog=ut,J.rangeAsinh=dt,J.orient=Zr,J.pxRatio=j,J.join=fn,J.fmtDate=Tn,J.tzDate=Dn,J.sync=Jr;{J.addGap=ni,J.clipGaps=ti;let e=J.paths={points:gi};e.linear=bi,e.stepped=xi,e.bars=Ci,e.spline=K}var Y=2400,Hi=class{onPick=()=>{};#e;#t=[];#n;constructor(e){this.#n=e,new ResizeObserver(()=>this.#e?.setSize({width:e.clientWidth,height:e.clientHeight})).observe(e)}show(e){if(this.#t=e,this.#e?.destroy(),this.#e=void 0,!e.length)return;let t={stroke:S(`--grid`),width:1},n={stroke:S(`--ink-3`),grid:t,ticks:t,font:`12px system-ui, sans-serif`},r={width:this.#n.clientWidth,height:this.#n.clientHeight,legend:{show:!1},scales:{x:{time:!1}},cursor:{drag:{x:!0,y:!1,setScale:!1},points:{show:!1}},axes:[{...n,size:28,values:(e,t)=>t.map((e,n)=>n===t.length-1?`${e} s`:`${e}`)},{...n,size:52,label:l(),labelSize:16,labelFont:`12px system-ui, sans-serif`}],series:[{},...e.map(e=>({label:e.figures.name,stroke:S(`--${e.look}`),width:1,points:{show:!1}}))],hooks:{setSelect:[e=>{let{left:t,width:n}=e.select;n>4&&this.#i(e.posToVal(t,`x`),e.posToVal(t+n,`x`)),e.setSelect({left:0,top:0,width:0,height:0},!1)}]}};this.#e=new J(r,this.#a(0,this.#r()),this.#n),this.#e.over.addEventListener(`click`,()=>{let e=this.#e.cursor.left??-1;e>=0&&this.onPick(this.#e.posToVal(e,`x`))}),this.#e.over.addEventListener(`dblclick`,()=>this.#i(0,this.#r()))}tool(e){let t=this.#e;t?.setCursor({left:t.valToPos(e,`x`),top:t.over.clientHeight/2},!1)}#r(){return Math.max(...this.#t.map(({t_s:e})=>e[e.length-1]??0))}#i(e,t){this.#e.setData(this.#a(e,t),!1),this.#e.batch(()=>{this.#e.setScale(`x`,{min:e,max:t})})}#a(e,t){let n=(t-e)/Y||1,r=Array.from({length:2401},(t,r)=>e+r*n);return[r,...this.#t.map(({t_s:t,error_um:i,cutting:a})=>{let o=r.map(()=>null),s=(e,t)=>{Math.abs(t)>Math.abs(o[e]??0)&&(o[e]=t)};for(let r=0;r<t.length;r++){let o=Math.round((t[r]-e)/n);if(!a[r]||o<0||o>Y)continue;let c=u(i[r]);if(s(o,c),!a[r+1])continue;let l=Math.min(Y,Math.round((t[r+1]-e)/n));for(let e=o+1;e<l;e++)s(e,c+(u(i[r+1])-c)*(e-o)/(l-o))}return o})]}};function X(t){let n=0,r=t=>{n=Math.max(0,t),e(`drop`).hidden=n===0};addEventListener(`dragenter`,e=>{e.preventDefault(),r(n+1)}),addEventListener(`dragleave`,()=>r(n-1)),addEventListener(`dragover`,e=>e.preventDefault()),addEventListener(`drop`,e=>{e.preventDefault(),r(0),t([...e.dataTransfer?.files??[]])})}var Ui=2**21,Wi=4e3,Gi=class{onChange=()=>{};#e;#t;#n=new Map;#r=0;#i=1;#a=0;#o;constructor(e,t){[this.#e,this.#t]=[e,t],e.addEventListener(`input`,()=>{this.#d(),this.onChange()}),e.addEventListener(`scroll`,()=>{this.#u(),this.#f()}),new ResizeObserver(()=>this.#f()).observe(e)}get isLong(){return!!this.#o}get value(){return this.#o?.program??this.#e.value}set value(e){let t=e.length>Ui;this.#o=t?{program:e,starts:Ki(e)}:void 0,this.#e.readOnly=t,this.#e.title=t?`The program is too long to be edited here.`:``,this.#r=this.#a=0,this.#n.clear(),t?this.#l(0):this.#e.value=e,this.#e.scrollTop=0,this.#d()}mark(e){this.#n=new Map([...e].reverse().map(({line:e,severity:t})=>[e,t])),this.#f()}current(e){e!==this.#r&&(this.#r=e,this.#c(e),this.#f())}go({line:e,column:t,length:n}){this.#c(e);let r=this.#e.value.split(`
`,e-this.#a).slice(0,-1).reduce((e,t)=>e+t.length+1,0)+Math.max(0,t-1);this.#e.focus(),this.#e.setSelectionRange(r,r+n),this.#c(e)}get#s(){return parseFloat(getComputedStyle(this.#e).lineHeight)}#c(e){this.#o&&(e<=this.#a||e>this.#a+this.#i)&&this.#l(e-Wi/2);let t=this.#s,n=(e-1-this.#a)*t,{scrollTop:r,clientHeight:i}=this.#e;(n<r||n>r+i-2*t)&&(this.#e.scrollTop=n-i/2)}#l(e){let{program:t,starts:n}=this.#o,r=n.length-1;this.#a=Math.max(0,Math.min(e,r-Wi)),this.#e.value=t.slice(n[this.#a],n[Math.min(r,this.#a+Wi)]),this.#d()}#u(){if(!this.#o)return;let{scrollTop:e,scrollHeight:t,clientHeight:n}=this.#e,r=this.#a;e>0&&e+n<t-1||(this.#l(e>0?r+Wi/2:r-Wi/2),this.#a!==r&&(this.#e.scrollTop=e+(r-this.#a)*this.#s))}#d(){this.#i=Ki(this.#e.value).length-1,this.#f()}#f(){let e=this.#s,{scrollTop:t,clientHeight:n}=this.#e,r=Math.floor(t/e)+1,i=Math.min(this.#i,r+Math.ceil(n/e)),a=[];for(let e=this.#a+r;e<=this.#a+i;e++){let t=document.createElement(`div`),n=this.#n.get(e);t.textContent=String(e),n&&t.classList.add(n),e===this.#r&&t.classList.add(`current`),a.push(t)}this.#t.replaceChildren(...a),this.#t.style.setProperty(`--shift`,`${(r-1)*e-t}px`)}};function Ki(e){let t=1;for(let n=-1;(n=e.indexOf(`
`,n+1))>=0;)t++;let n=new Uint32Array(t+1);for(let r=1;r<t;r++)n[r]=e.indexOf(`
`,n[r-1])+1;return n[t]=e.length,n}var qi,Ji=``;function Yi(){return qi??=Xi(`engine.wasm.gz`),qi}async function Xi(e){let t=await fetch(e);if(!t.ok||!t.body)throw Error(`${e} is missing: ${t.status}`);let n=crypto.subtle&&t.clone().arrayBuffer().then(e=>crypto.subtle.digest(`SHA-256`,e)),r=t.body.getReader(),i=await r.read(),a=new ReadableStream({start:e=>i.value?e.enqueue(i.value):e.close(),pull:async e=>{let{done:t,value:n}=await r.read();t?e.close():e.enqueue(n)}}),o=i.value?.[0]===31&&i.value[1]===139?a.pipeThrough(new DecompressionStream(`gzip`)):a,s=await WebAssembly.compileStreaming(new Response(o,{headers:{"Content-Type":`application/wasm`}}));return n&&(Ji=[...new Uint8Array(await n)].map(e=>e.toString(16)).join(`-`)),s}var Zi=class extends Error{},Qi=class{#e;#t=new Map;#n=0;async ask(e,t={}){let n=await Yi(),r=this.#e??=this.#r(),i=++this.#n;return new Promise((a,o)=>{this.#t.set(i,{resolve:a,reject:o,listener:t}),r.postMessage({id:i,module:n,engine:Ji,request:e})})}cancel(){this.#e?.terminate(),this.#e=void 0;let e=[...this.#t.values()];this.#t.clear(),e.forEach(e=>e.reject(new Zi(`cancelled`)))}#r(){let e=new Worker(new URL(new URL(`engine.js`,import.meta.url).href,``+import.meta.url),{type:`module`,name:`engine`});return e.onmessage=({data:e})=>{let t=this.#t.get(e.id);t&&(e.kind===`progress`?t.listener.progress?.(e.stage,e.part):e.kind===`points`?t.listener.points?.(e.points):(this.#t.delete(e.id),e.kind===`done`?t.resolve(e.answer):t.reject(Error(e.reason))))},e.onerror=e=>{this.#t.forEach(t=>t.reject(Error(e.message||`the engine does not start`))),this.#t.clear()},e}},$i;function ea(t,n,r){$i={stem:t,identified:r};let{axes:i,findings:a,improvements:o,advice:s}=r;e(`log`).textContent=`${n}. Numbers with their intervals of 90 %. Run cuts on this machine.`,e(`axes`).replaceChildren(...i.map(ta),...[[`What the log is taken for`,a],[`What would be better`,o],[`What to record next`,s]].map(([e,t])=>na(e,t))),e(`identified`).hidden=!1}function ta({name:e,verdict:n,numbers:r}){let i=t(`div`),a=t(`table`),o=t(`tbody`),s=t(`tr`);return s.append(...[`Number`,`Value`,`90 %`].map(e=>Object.assign(t(`th`,e),{scope:`col`}))),a.append(t(`thead`),o),a.tHead.append(s),o.append(...r.map(([e,n,r,i,a])=>{let o=t(`tr`),s=t(`th`,e);return s.scope=`row`,s.append(t(`small`,a)),o.append(s,t(`td`,`${n} ${r}`),t(`td`,i.replace(` to `,` – `))),o})),i.append(t(`h3`,`Axis ${e}`),t(`p`,n.replace(/ um\b/g,` µm`)),a),i}function na(e,n){let r=t(`details`),i=t(`ul`);return r.hidden=!n.length,i.append(...n.map(e=>t(`li`,e))),r.append(t(`summary`,e),i),r}function ra(){e(`machine-file`).addEventListener(`click`,()=>$i&&i(`${$i.stem}.toml`,new Blob([$i.identified.file],{type:`text/plain`}))),e(`identification`).addEventListener(`click`,()=>$i&&i(`${$i.stem}.html`,$i.identified.page))}function ia(e,n){let r=t(`li`,``,e.severity),i=sa(r,n);return i.append(t(`b`,`${e.line}:${e.column} ${e.severity}`),` ${e.message}`),e.hint&&i.append(t(`small`,`hint: ${e.hint}`)),r}function aa(e,n,r,i){let a=t(`li`),o=sa(a,()=>{i(),a.parentElement.querySelectorAll(`[aria-current]`).forEach(e=>e.removeAttribute(`aria-current`)),o.setAttribute(`aria-current`,`true`)});return o.append(t(`b`,e),t(`span`,`line ${n}`),t(`code`,r)),a}function oa({t_s:e,line:t},n){let r=new Map;for(let n=0;n+1<e.length;n++){let i=r.get(t[n])??{line:t[n],time_s:0,t_s:e[n]};i.time_s+=e[n+1]-e[n],r.set(t[n],i)}return[...r.values()].sort((e,t)=>t.time_s-e.time_s).slice(0,n)}function sa(e,n){let r=e.appendChild(t(`button`));return r.type=`button`,r.addEventListener(`click`,n),r}function ca(e,n){e.querySelectorAll(`.unit`).forEach(e=>e.textContent=l()),e.querySelector(`tbody`).replaceChildren(...n.map(({name:e,look:n,numbers:r})=>{let i=t(`tr`),a=t(`th`,e,n?`run ${n}`:``);return a.scope=`row`,i.append(a,...r.map(e=>t(`td`,e))),i}))}var la=({name:e,time_s:t,rms_um:n,max_um:r})=>({name:e,numbers:[t,d(n),d(r)]}),ua=[`Amplifiers are off`,`Not delayed, not corrected`,`Delayed, not corrected`,`The correction fades out`,`Correcting`],da=2,fa=200,pa=60,ma=class{onRows=()=>{};#e=[];async start(){e(`live`).hidden=!1,e(`live-clear`).addEventListener(`click`,()=>this.#e=[]);for(let e=0;;await new Promise(e=>setTimeout(e,fa))){let t=await fetch(`hal/${e}`).then(e=>e.json()).catch(()=>void 0);t?(e=t.next,this.#e=[...this.#e,...t.rows].slice(-7500),this.#t(t.trouble??``,t.now??void 0),this.show()):this.#t(`'feedwright open' has ended. Start it again.`,void 0)}}show(){if(!this.#e.length)return;let t=this.#e[this.#e.length-1][0],n=this.#e.filter(([e])=>e>t-pa),[r,i]=[ga(n,`without correction`,5,`run-0`),ga(n,`measured`,4,`run-1`)];ca(e(`live-figures`),[r,i].map(({figures:{name:e,max_um:t},look:n,error_um:r})=>({name:e,look:n,numbers:[d(r[r.length-1]),d(t)]}))),this.onRows(ga(this.#e,`measured`,4,`run-1`),[r,i])}#t(t,n){ha(`live-state`,n?`${ua[n.state]??`State ${n.state}`}${n.enable?``:`. The correction is switched off`}`:t),ha(`live-cause`,n?.cause?`${n.fault?`Fault`:`Last fault`}: ${n.cause}`:``),e(`live-cause`).classList.toggle(`alarm`,!!n?.fault);let r=n?.correction_um.map((e,t)=>`${`XYZ`[t]} ${d(e).replace(`-`,`−`)}`).join(`  `);ha(`live-correction`,n?`Correction ${r} of ${d(n.limit_um)} ${l()}`:``)}};function ha(t,n){e(t).textContent!==n&&(e(t).textContent=n)}function ga(e,t,n,r){let i=e[0][0],a=new Float32Array(e.map(e=>e[n])),o=new Uint8Array(e.map(e=>Number(e[6]>=da)));return{figures:{name:t,time_s:``,rms_um:``,max_um:Math.max(...a.map((e,t)=>o[t]?e:0)).toFixed(2)},look:r,error_um:a,cutting:o,worst:[],limits:[],t_s:new Float32Array(e.map(([e])=>e-i)),line:new Uint32Array(e.length),foot_mm:new Float32Array(e.flatMap(([,e,t,n])=>[e,t,n])),deviation_mm:new Float32Array(3*e.length)}}var _a=class{play;slider;speed;onMove=()=>{};#e;#t=0;#n;constructor(e,t,n){this.play=e,this.slider=t,this.speed=n,e.addEventListener(`click`,()=>this.#n?this.stop():this.#r()),t.addEventListener(`input`,()=>{this.stop(),this.time(Number(t.value))}),n.addEventListener(`change`,()=>this.#n&&this.#r())}show(e){this.stop(),this.#e=e,this.#t=0;let t=e?e.t_s[e.t_s.length-1]:0;[this.slider.max,this.slider.step,this.slider.value]=[String(t),String(t/2e3||1),`0`],this.play.disabled=this.slider.disabled=this.speed.disabled=!e}time(e){let t=this.#e?.t_s;if(!t)return;let[n,r]=[0,t.length-1];for(;n<r;){let i=n+r>>1;t[i]<e?n=i+1:r=i}this.index(n>0&&e-t[n-1]<t[n]-e?n-1:n)}index(e){this.#e&&(this.#t=e,this.slider.value=String(this.#e.t_s[e]),this.onMove(e))}stop(){this.#n=void 0,this.play.textContent=`Play`}#r(){let e=this.#e?.t_s;if(!e)return;let t=this.#t>=e.length-1?0:e[this.#t],n={at:performance.now(),t_s:t};this.#n=n,this.play.textContent=`Pause`;let r=()=>{if(this.#n!==n)return;let i=t+(performance.now()-n.at)/1e3*Number(this.speed.value);this.time(i),i>=e[e.length-1]?this.stop():requestAnimationFrame(r)};requestAnimationFrame(r)}},va=`mine.toml`,ya=e=>`${e}/min`,ba=e=>e,xa=[{name:`feed`,asks:`Fastest cutting feed`,unit:ya,value:12e3,least:1,most:6e5,help:`A higher F is cut at this.`},{name:`rapid`,asks:`Rapid`,unit:ya,value:12e3,least:1,most:6e5,help:`Speed of G0.`},{name:`accel`,asks:`Acceleration of an axis`,unit:e=>`${e}/s²`,value:2e3,least:1,most:1e5,help:`LinuxCNC: MAX_ACCELERATION.`},{name:`lead`,asks:`Travel in one turn of the motor`,unit:ba,value:10,least:.1,most:500,help:`Lead of the screw, or of pulley and belt.`},{name:`lag`,asks:`Following error at the fastest feed`,unit:ba,value:.2,least:1e-4,most:50,help:`LinuxCNC: joint.N.f-error while the axis moves.`},{name:`servo`,asks:`Servo period`,unit:()=>`ms`,value:1,least:.1,most:10,help:`LinuxCNC: SERVO_PERIOD / 1,000,000.`}],Sa=50;function Ca(e,t){let n=Math.min(t/e,Sa);return{gain_1_s:n,feedforward:1-n*e/t}}function wa(e){let t=e=>Number(e.toPrecision(9)),[n,r]=[e.feed/60,e.rapid/60],{gain_1_s:i,feedforward:a}=Ca(e.lag,n),o=Object.entries({lead_mm_per_rev:e.lead,kp_1_s:i,velocity_feedforward:a,max_velocity_mm_s:Math.max(n,r),max_accel_mm_s2:e.accel,max_jerk_mm_s3:e.accel/.04}).map(([e,n])=>`${e} = ${t(n)}\n`).join(``);return`# From six numbers; everything that is not here is that of workshop. A log of the machine tells it better: feedwright excite.

base = "workshop"
name = "mine"
description = "six numbers of a machine; the rest is that of workshop"
source = "answers to six questions"

[period]
servo_s = ${t(e.servo/1e3)}

[limits]
rapid_mm_s = ${t(r)}
max_feed_mm_s = ${t(n)}
tangential_accel_mm_s2 = ${t(e.accel)}
normal_accel_mm_s2 = ${t(e.accel)}
${[`x`,`y`,`z`].map(e=>`\n[axis.${e}] # the jerk reaches the acceleration in 40 ms\n${o}`).join(``)}`}function Ta(n){let r=e(`questions`),o=r.querySelector(`form`),s,l=e=>e(`mm`)===e(`in`)||s===`mm`?1:a,u=()=>{s!==c()&&(s=c(),e(`asked`).replaceChildren(...xa.map(({name:e,asks:n,unit:r,value:i,least:a,most:o,help:c})=>{let u=t(`label`),d=t(`input`),f=l(r);return Object.assign(d,{name:e,type:`number`,required:!0,step:`any`,value:String(Number((i/f).toPrecision(4))),min:String(a/f),max:String(o/f)}),u.append(t(`span`,n),d,t(`span`,r(s)),t(`small`,c)),u})))},d=()=>{let e=new FormData(o);return wa(Object.fromEntries(xa.map(({name:t,unit:n})=>[t,Number(e.get(t))*l(n)])))};e(`describe`).addEventListener(`click`,()=>{u(),r.showModal()}),e(`unasked`).addEventListener(`click`,()=>r.close()),e(`described`).addEventListener(`click`,()=>o.reportValidity()&&i(`mine.toml`,new Blob([d()]))),o.addEventListener(`submit`,e=>{e.preventDefault(),r.close(),n(d())})}function Ea(e,t,n){let r=e.length/3,i=new Int16Array(r).fill(-1),a=new Uint32Array(t+1);for(let e=1;e<r;e++)i[e]=n(e),i[e]>=0&&a[i[e]+1]++;for(let e=0;e<t;e++)a[e+1]+=a[e];let o=new Uint32Array(a[t]),s=a.slice();for(let e=1;e<r;e++)i[e]>=0&&(o[s[i[e]]++]=e);return{count:r,points:e,ends:o,starts:a}}var Da=.7,Oa=32;function ka(e,{ends:t,starts:n},r,{at:i,width:a,height:o,oneOf:s}){let c=-1,l=0,u=0;for(let d=n[r];d<n[r+1];d++){let f=t[d];if(s>1&&Math.floor(f/Oa)%s)continue;let p=i[2*f],m=i[2*f+1],h=i[2*f-2],g=i[2*f-1];p<0&&h<0||m<0&&g<0||p>a&&h>a||m>o&&g>o||(c!==f-1&&(e.moveTo(h,g),l=h,u=g),c=f,d+1<n[r+1]&&t[d+1]===f+1&&Math.abs(p-l)+Math.abs(m-u)<Da||(e.lineTo(p,m),l=p,u=m))}}var Aa={top:[[1,0,0],[0,1,0]],front:[[1,0,0],[0,0,1]],right:[[0,1,0],[0,0,1]],iso:[[Math.SQRT1_2,Math.SQRT1_2,0],[-.408248,.408248,.816497]]},ja=24,[Z,Ma]=[50,20],Na=256,Pa=200,Fa=class{gain=0;onPick=()=>{};#e;#t;#n=`top`;#r={x:0,y:0,scale:1};#i=!0;#a;#o;#s;#c;#l;#u=1;#d=[];#f;#p=new Float32Array;#m=0;#h=1;#g=-1/0;#_=0;#v;constructor(e){[this.#e,this.#t]=[0,1].map(()=>e.appendChild(document.createElement(`canvas`))),this.#t.tabIndex=0,this.#t.setAttribute(`role`,`img`),new ResizeObserver(()=>this.#D()).observe(e),this.#k()}get shownGain(){return this.#o?this.gain||this.#b():1}get largest_um(){return this.#u}describe(e){this.#t.setAttribute(`aria-label`,e)}program({points:e,kinds:t}){this.#a=Ea(e,2,e=>t[e]&1),this.#v=La(e),this.#i&&this.fit(),this.redraw()}cut(e,t){this.#o=e,this.#u=t||1,this.#d=[],this.#f=void 0,this.regain()}compare(e){this.#c=e,this.regain()}add(e){this.#d.push(e);let t=e.length-4;t>=0&&(this.#f=[e[t],e[t+1],e[t+2]]),this.redraw()}side(e){this.#n=e,this.fit()}fit(){if(this.#i=!0,!this.#v)return;let e=[0,1,2,3,4,5,6,7].map(e=>this.#w([0,1,2].map(t=>this.#v[e>>t&1][t]))),[t,n]=[e.map(([e])=>e),e.map(([,e])=>e)],[r,i,a,o]=[Math.min(...t),Math.max(...t),Math.min(...n),Math.max(...n)],{clientWidth:s,clientHeight:c}=this.#e,l=e=>Math.max(1,e-56),u=Math.min(l(s)/Math.max(i-r,1e-6),l(c)/Math.max(o-a,1e-6));this.#r={x:(r+i)/2,y:(a+o)/2,scale:Math.min(u,1e5)},this.redraw()}zoomTo(e){if(!this.#v)return;let[t,n]=this.#v,r=Math.hypot(n[0]-t[0],n[1]-t[1],n[2]-t[2]),[i,a]=this.#w(e);this.#i=!1,this.#r={x:i,y:a,scale:Math.min(this.#e.clientWidth,this.#e.clientHeight)/Math.max(.1*r,.001)},this.redraw()}tool(e){let t=this.#o,n=this.#s?.points;this.#f=t&&n&&e!==void 0?[0,1,2].map(t=>n[3*e+t]):void 0,this.#S()}redraw(){this.#m||=requestAnimationFrame(()=>{this.#m=0,this.draw()})}#y(){this.#i=!1,clearTimeout(this.#_),this.#_=setTimeout(()=>{this.#g=-1/0,this.redraw()},Pa),this.#m||=requestAnimationFrame(e=>{this.#m=0;let t=e-this.#g;this.#g=e,t<1e3&&t>Z?this.#h=Math.min(Na,2*this.#h):t<Ma&&(this.#h=Math.max(1,this.#h/2)),this.draw(this.#h)})}draw(e=1){let t=this.#e.getContext(`2d`),n=devicePixelRatio,{clientWidth:r,clientHeight:i}=this.#e;t.setTransform(n,0,0,n,0,0),t.clearRect(0,0,r,i),t.lineJoin=`round`,this.#C(t,r,i);let a=(n,a,o)=>{t.beginPath(),ka(t,n,a,{at:o,width:r,height:i,oneOf:e}),t.stroke()};if(this.#a){let e=this.#E(this.#a.points);[t.lineWidth,t.strokeStyle]=[1,S(`--rapid`)],t.setLineDash([3,4]),a(this.#a,0,e),t.setLineDash([]),[t.lineWidth,t.strokeStyle]=[1,S(`--path`)],a(this.#a,1,e)}if(this.#l){let e=this.#E(this.#l.points);[t.lineWidth,t.strokeStyle]=[1,S(`--kept`)],a(this.#l,0,e)}if(this.#s){let e=this.#E(this.#s.points);t.lineWidth=this.#s.ends.length>3e4?1:1.8;for(let n=0;n<ja;n++)t.strokeStyle=E((n+.5)/ja),a(this.#s,n,e)}this.#x(t),this.#S()}regain(){let[e,t,n]=[this.#o,this.#c,this.shownGain],r=t=>e.cutting[t]?Math.min(23,Math.floor(ja*Math.abs(e.error_um[t])/this.#u)):-1;this.#s=e&&Ea(Ia(e,n),ja,r),this.#l=e&&t&&Ea(Ia(t,n),1,e=>t.cutting[e]?0:-1),this.redraw()}#b(){if(!this.#v)return 1;let[e,t]=this.#v,n=.02*Math.hypot(t[0]-e[0],t[1]-e[1])/(.001*this.#u),r=10**Math.floor(Math.log10(n));return Math.max(1,r*([5,2,1].find(e=>e*r<=n)??1))}#x(e){if(!this.#d.length)return;e.lineWidth=1.8,e.strokeStyle=S(`--run-1`),e.beginPath();let t=!1;for(let n of this.#d)for(let r=0;r<n.length;r+=4){let[i,a]=this.#T([n[r],n[r+1],n[r+2]]);Number.isNaN(n[r+3])?t=!1:t?e.lineTo(i,a):(e.moveTo(i,a),t=!0)}e.stroke()}#S(){let e=this.#t.getContext(`2d`),t=devicePixelRatio;if(e.setTransform(t,0,0,t,0,0),e.clearRect(0,0,this.#t.clientWidth,this.#t.clientHeight),!this.#f)return;let[n,r]=this.#T(this.#f);e.fillStyle=S(`--panel`),e.strokeStyle=S(`--ink`),e.lineWidth=2,e.beginPath(),e.arc(n,r,5,0,2*Math.PI),e.fill(),e.stroke()}#C(e,t,n){let{x:r,y:i,scale:a}=this.#r,o=64/a,s=10**Math.floor(Math.log10(o)),c=s*([2,5,10].find(e=>e*s>=o)??10);e.strokeStyle=S(`--grid`),e.lineWidth=1,e.beginPath();for(let i=Math.ceil((r-t/2/a)/c);i*c<r+t/2/a;i++){let o=Math.round(t/2+(i*c-r)*a)+.5;e.moveTo(o,0),e.lineTo(o,n)}for(let r=Math.ceil((i-n/2/a)/c);r*c<i+n/2/a;r++){let o=Math.round(n/2-(r*c-i)*a)+.5;e.moveTo(0,o),e.lineTo(t,o)}e.stroke(),this.onGrid(c,this.#n)}onGrid=()=>{};#w([e,t,n]){let[r,i]=Aa[this.#n];return[r[0]*e+r[1]*t+r[2]*n,i[0]*e+i[1]*t+i[2]*n]}#T(e){let[t,n]=this.#w(e),{x:r,y:i,scale:a}=this.#r;return[this.#e.clientWidth/2+(t-r)*a,this.#e.clientHeight/2-(n-i)*a]}#E(e){let t=e.length/3,[n,r]=Aa[this.#n],{x:i,y:a,scale:o}=this.#r;this.#p.length<2*t&&(this.#p=new Float32Array(2*t));let s=this.#p,[c,l]=[this.#e.clientWidth/2-i*o,this.#e.clientHeight/2+a*o];for(let i=0;i<t;i++){let t=e[3*i],a=e[3*i+1],u=e[3*i+2];s[2*i]=c+o*(n[0]*t+n[1]*a+n[2]*u),s[2*i+1]=l-o*(r[0]*t+r[1]*a+r[2]*u)}return s}#D(){for(let e of[this.#e,this.#t])e.width=Math.round(e.clientWidth*devicePixelRatio),e.height=Math.round(e.clientHeight*devicePixelRatio);this.#i&&this.fit(),this.draw()}pan(e,t){this.#r.x-=e/this.#r.scale,this.#r.y+=t/this.#r.scale,this.#y()}zoom(e,t=this.#e.clientWidth/2,n=this.#e.clientHeight/2){let r=this.#r,[i,a]=[t-this.#e.clientWidth/2,this.#e.clientHeight/2-n],o=Math.min(1e6,Math.max(1e-4,r.scale*e));r.x+=i/r.scale-i/o,r.y+=a/r.scale-a/o,r.scale=o,this.#y()}#O(e,t){if(!this.#s)return;let n=this.#E(this.#s.points),[r,i]=[void 0,576];for(let a=0;a<this.#s.count;a++){let o=(n[2*a]-e)**2+(n[2*a+1]-t)**2;o<i&&([r,i]=[a,o])}return r}#k(){let e=this.#t,t=new Map,n=0;e.addEventListener(`wheel`,e=>{e.preventDefault(),this.zoom(Math.exp(-.0015*e.deltaY*(e.deltaMode===1?16:1)),e.offsetX,e.offsetY)},{passive:!1}),e.addEventListener(`pointerdown`,r=>{e.setPointerCapture(r.pointerId),t.set(r.pointerId,{x:r.offsetX,y:r.offsetY}),t.size===1&&(n=0)}),e.addEventListener(`pointermove`,e=>{let r=t.get(e.pointerId);if(!r)return;let i={x:e.offsetX,y:e.offsetY},a=[...t].find(([t])=>t!==e.pointerId)?.[1];if(a){let e=e=>Math.hypot(e.x-a.x,e.y-a.y);this.zoom(e(i)/Math.max(1,e(r)),(i.x+a.x)/2,(i.y+a.y)/2)}let o=a?.5:1;this.pan(o*(i.x-r.x),o*(i.y-r.y)),n+=Math.abs(i.x-r.x)+Math.abs(i.y-r.y),t.set(e.pointerId,i)});let r=e=>{if(t.delete(e.pointerId)&&e.type===`pointerup`&&n<4){let t=this.#O(e.offsetX,e.offsetY);t!==void 0&&this.onPick(t)}};e.addEventListener(`pointerup`,r),e.addEventListener(`pointercancel`,r),e.addEventListener(`dblclick`,()=>this.fit());let i={ArrowLeft:()=>this.pan(40,0),ArrowRight:()=>this.pan(-40,0),ArrowUp:()=>this.pan(0,40),ArrowDown:()=>this.pan(0,-40),"+":()=>this.zoom(1.25),"=":()=>this.zoom(1.25),"-":()=>this.zoom(.8),0:()=>this.fit()};e.addEventListener(`keydown`,e=>{let t=!e.ctrlKey&&!e.metaKey&&i[e.key];t&&(e.preventDefault(),t())})}},Ia=({foot_mm:e,deviation_mm:t},n)=>e.map((e,r)=>e+n*t[r]);function La(e){if(!e.length)return;let[t,n]=[[1/0,1/0,1/0],[-1/0,-1/0,-1/0]];for(let r=0;r<e.length;r++)t[r%3]=Math.min(t[r%3],e[r]),n[r%3]=Math.max(n[r%3],e[r]);return[t,n]}var Q=new Fa(e(`view`)),Ra=new Hi(e(`curve`)),za=new Gi(e(`text`),e(`gutter`)),Ba=new ma,Va=new _a(e(`play`),e(`time`),e(`speed`)),[Ha,Ua,Wa]=[new Qi,new Qi,new Qi],Ga=e(`machine`),Ka=e(`controller`),qa=e(`example`),Ja=e(`control`),Ya=5,$={name:`program.ngc`,part:``,lists:void 0,file:void 0,machineFile:void 0,checked:void 0,answer:void 0,corrected:void 0,kept:void 0,shown:0};function Xa(){let e=Ga.value===`file`&&$.machineFile;return{name:$.name,program:za.isLong&&$.file||za.value,machine:e?`${$.machineFile.text}\n`:Ga.value,machine_name:e?$.machineFile.name:void 0}}var Za=()=>new Date().toISOString().slice(0,10);function Qa(t,n,{example:r=``,part:i=``,file:a=void 0}={}){return[$.name,$.part,$.file]=[t,i,a],za.value=n,qa.value=r,e(`name`).textContent=t,document.title=`${t} · feedwright`,e(`welcome`).hidden=!0,Q.fit(),oo(),no(),co()}async function $a(...e){await Promise.all([Qa(...e),uo()])}var eo=e=>$a(`${e}.ngc`,D[e].program,{example:e});async function to(e){let t=await fetch(`parts/${e}`);t.ok?await $a(e,await t.text(),{part:e}):_o(`parts/${e} is not there.`)}var no=()=>$.lists&&v($.lists,$.part),ro=2**29;async function io(e){for(let t of e)try{if(t.size>=ro)throw Error(`it has ${m(t.size)}, and a browser holds ${m(ro)}. Use the command: feedwright run`);/\.toml$/i.test(t.name)?ao(t.name,await t.text()):/\.(csv|log|json)$/i.test(t.name)?await po(t.name,t):await Qa(t.name,await t.text(),{file:t})}catch(e){_o(`${t.name} cannot be opened: ${e.message}`)}}function ao(e,t){$.machineFile={name:e,text:t},Ga.querySelector(`[value=${g}]`)?.remove(),Ga.prepend(new Option(e,g)),Ga.value=g,oo(),co()}function oo(){Ua.cancel(),[$.answer,$.corrected,$.shown]=[void 0,void 0,0],_o(``),bo(),Do()}var so=0;async function co(){let t=++so;if(Ha.cancel(),!$.lists||!za.value.trim()){$.checked=void 0,vo();return}let n=setTimeout(()=>e(`amounts`).textContent=`Reading the program. If it does not end, change it, or press Esc.`,2e3);try{let e=await Ha.ask({...Xa(),task:`check`});if(t!==so)return;$.checked=e,vo()}catch(n){if(t!==so)return;e(`amounts`).textContent=``,n instanceof Zi||_o(String(n.message))}finally{clearTimeout(n)}}async function lo(t){Ua.cancel(),_o(``);let n=performance.now(),r=``,i=(t,i)=>{t!==r&&([r,n]=[t,performance.now()]);let a=(performance.now()-n)/1e3*(1/i-1);e(`stage`).textContent=t,e(`bar`).value=i,e(`left`).textContent=i>.05&&i<1&&a>=1?`${Math.ceil(a)} s left in this step`:``};ho(!0),i(`starting`,0);try{await t(i)}catch(e){if(e instanceof Zi)return;_o(String(e.message))}ho(!1)}async function uo(){await lo(async e=>{Q.cut(void 0,1);let t={...Xa(),task:`run`,controller:Ka.value,recorded_on:Za(),page:!0};$.answer=await Ua.ask(t,{progress:e,points:e=>Q.add(e)}),bo()}),$.answer||Q.cut(void 0,1)}async function fo(){await lo(async e=>{$.corrected=await Ua.ask({...Xa(),task:`correct`,target:Ja.value},{progress:e}),Do()})}async function po(e,t){await lo(async n=>{let r=e.replace(/\.[^.]*$/,``),i=await Ua.ask({task:`identify`,name:e,program:t},{progress:n});ao(`${r}.toml`,i.file),ea(r,e,i)})}function mo(){Ha.cancel(),Ua.cancel(),ho(!1),$.answer||Q.cut(void 0,1)}function ho(t){e(`work`).hidden=!t,document.body.classList.toggle(`busy`,t),go()}function go(){let t=!!$.lists&&!!$.checked?.amounts&&e(`work`).hidden;for(let n of[`run`,`correct`])e(n).disabled=!t}function _o(t){e(`message`).textContent=t,e(`message`).hidden=!t}function vo(){let{checked:t}=$,n=t?.findings??[];t&&Q.program(t),za.mark(n),e(`findings`).replaceChildren(...n.slice(0,200).map(e=>ia(e,()=>za.go(e))));let r=t?.amounts,i=n.filter(({severity:e})=>e===`error`).length;e(`amounts`).textContent=r?`${r.lines} lines, ${r.motions} motions, ${p(r.feed_mm)} of cuts, ${p(r.rapid_mm)} of rapids. Read as ${r.dialect}.`:i?`${i} mistake${i===1?``:`s`}: nothing can be cut.`:``,go()}var yo=e=>Math.max(...e.map(({figures:e})=>Number(e.max_um)).filter(Number.isFinite),0);function bo(){let{answer:n}=$,r=n?.cuts??[],i=xo();for(let t of[`figures`,`report`,`keep`,`live-show`])e(t).hidden=!n;e(`keep`).setAttribute(`aria-pressed`,String(!!$.kept)),e(`verdict`).textContent=n?.verdict.split(` Cost:`)[0]??`Run shows what the machine will cut without a correction and with the controller.`,ca(e(`figures`),i.map(({figures:e,look:t})=>({...la(e),look:t}))),e(`shown`).replaceChildren(...r.map(({figures:e},n)=>{let r=t(`button`,e.name);return r.type=`button`,r.addEventListener(`click`,()=>Co(n)),r})),Ra.show(i),e(`key`).replaceChildren(t(`b`,`Contour error over time`),...i.map(({figures:e,look:n})=>t(`span`,e.name,`run ${n}`))),Co(Math.min($.shown,Math.max(0,r.length-1)))}function xo(){let{answer:e,kept:t}=$;return!e||!t?e?.cuts??[]:e.cuts.some(({t_s:e})=>e===t.t_s)?e.cuts:[...e.cuts,t]}function So(){let e=$.answer?.cuts[$.shown],t=`${e?.figures.name} before: ${$.name} on ${Ga.selectedOptions[0].text}`;$.kept=$.kept||!e?void 0:{...e,look:`kept`,figures:{...e.figures,name:t}},bo()}function Co(t){$.shown=t;let n=$.answer?.cuts??[],r=n[t];[...e(`shown`).children].forEach((e,n)=>e.setAttribute(`aria-pressed`,String(n===t))),Q.cut(r,yo(n)),Q.compare(xo()[n.length]),Va.show(r),e(`readout`).textContent=``,wo(r),To(yo(n)),Q.describe(r?`Path of ${$.name}, ${r.figures.name}: largest contour error ${d(r.figures.max_um)} ${l()}. Arrow keys move, + and − zoom, 0 fits.`:`Path of ${$.name}`)}function wo(t){let n=(t,n)=>{e(t).replaceChildren(...n),e(`${t}-title`).hidden=!n.length};n(`worst`,(t?.worst??[]).map(({error_um:e,line:t,text:n,position_mm:r,t_s:i})=>aa(`${d(Math.abs(e))} ${l()}`,t,n,()=>{Q.zoomTo(r),Va.time(i)}))),n(`record`,(t?.figures.record??[]).map(({t_s:e,line:t,text:n})=>aa(`${e.toFixed(3)} s`,t,n,()=>Va.time(e))));let r=za.isLong?[]:za.value.split(`
`);n(`slow`,(t?oa(t,Ya):[]).map(({line:e,time_s:t,t_s:n})=>aa(`${t.toFixed(3)} s`,e,r[e-1]?.trim()??``,()=>Va.time(n)))),n(`limits`,(t?.limits??[]).map(([e,n,r])=>aa(`${Math.round(n)} %`,r,e,()=>Va.time(t.t_s[t.line.indexOf(r)]))))}function To(t){e(`legend`).hidden=!t,e(`largest`).textContent=`${d(t)} ${l()}`,Eo()}function Eo(){let t=Q.shownGain;e(`gain-now`).textContent=t>1?`errors drawn ${t} times too large`:``}function Do(){let{corrected:t}=$;if(e(`corrected`).hidden=!t,!t)return;ca(e(`corrected`),t.figures.map(la));let{refusal:n,hint:r,stretches:i,stretches_changed:a,rounds:o}=t;e(`correction`).textContent=n?`No corrected program: ${n}.${r?` Hint: ${r}.`:``}`:`${a} of ${i} stretches between corners were changed, found in ${o} simulated cuts. Both cut without feedback, as the control plans them.`;for(let r of[`download`,`take`])e(r).hidden=!t.program||!!n}function Oo(t){let n=$.answer?.cuts[$.shown];if(!n)return;Q.tool(t),Ra.tool(n.t_s[t]),za.current(n.line[t]);let r=[0,1,2].map(e=>f(n.foot_mm[3*t+e]+n.deviation_mm[3*t+e])),i=n.cutting[t]?`error ${d(Math.abs(n.error_um[t]))} ${l()}`:`rapid or rest`;e(`readout`).textContent=`${n.t_s[t].toFixed(3)} s   line ${n.line[t]}   X ${r[0]}  Y ${r[1]}  Z ${r[2]} ${c()}   ${i}`}function ko(){let t=e(`colors`),n=t.getContext(`2d`);for(let e=0;e<t.width;e++)n.fillStyle=E(e/t.width),n.fillRect(e,0,1,t.height)}var Ao=()=>$.name.replace(/\.[^.]*$/,``);function jo(e){s(e),n(`[data-units]`,t=>t.dataset.units===e)}function Mo(){e(`open`).addEventListener(`click`,()=>e(`file`).click()),e(`file`).addEventListener(`change`,e=>{let t=e.target;io([...t.files??[]]).then(()=>t.value=``)}),qa.addEventListener(`change`,()=>qa.value&&eo(qa.value));let t=0;za.onChange=()=>{qa.value=$.part=``,e(`welcome`).hidden=!0,clearTimeout(t),t=setTimeout(()=>{oo(),no(),co()},200)};for(let e of[Ga,Ka])e.addEventListener(`change`,()=>{oo(),no(),co()});Ja.addEventListener(`change`,()=>{$.corrected=void 0,Do(),no()}),e(`run`).addEventListener(`click`,()=>void uo()),e(`correct`).addEventListener(`click`,fo),e(`cancel`).addEventListener(`click`,mo),document.addEventListener(`keydown`,t=>{t.key===`Enter`&&(t.ctrlKey||t.metaKey)?e(`run`).click():t.key===`Escape`&&mo()}),No(),ra(),Po(),X(io),Ta(e=>ao(va,e))}function No(){e(`report`).addEventListener(`click`,()=>$.answer&&i(`${Ao()}.report.html`,$.answer.report)),e(`keep`).addEventListener(`click`,So);let t=()=>new Blob([$.corrected.program],{type:`text/plain`});e(`download`).addEventListener(`click`,()=>$.corrected&&i(`${Ao()}.corrected.ngc`,t())),e(`take`).addEventListener(`click`,()=>$.corrected&&Qa(`${Ao()}.corrected.ngc`,$.corrected.program))}function Po(){document.querySelectorAll(`[data-units]`).forEach(e=>e.addEventListener(`click`,()=>{jo(e.dataset.units),no(),vo(),bo(),Do()})),document.querySelectorAll(`[data-side]`).forEach(e=>e.addEventListener(`click`,()=>{Q.side(e.dataset.side),n(`[data-side]`,t=>t===e)})),e(`fit`).addEventListener(`click`,()=>Q.fit()),e(`gain`).addEventListener(`change`,e=>{Q.gain=Number(e.target.value),Q.regain(),Eo()}),Q.onGrid=(t,n)=>{let r={top:`X right, Y up`,front:`X right, Z up`,right:`Y right, Z up`,iso:`from the front left, above`}[n];e(`scale`).textContent=$.checked||!e(`live`).hidden?`grid ${p(t)} · ${r}`:``},Q.onPick=e=>{Va.stop(),Va.index(e)},Ra.onPick=e=>{Va.stop(),Va.time(e)},Va.onMove=Oo,matchMedia(`(prefers-color-scheme: dark)`).addEventListener(`change`,()=>{ko(),Q.redraw(),Ra.show(xo())})}function Fo(){e(`welcome`).hidden=!0,e(`live-show`).addEventListener(`click`,oo),Ba.onRows=(t,n)=>{if($.answer||!e(`work`).hidden)return;let r=yo([t]);$.checked||Q.program({points:t.foot_mm,kinds:new Uint32Array(t.line.length)}),Q.cut(t,r),Q.tool(t.line.length-1),Q.describe(`Path of the machine. Arrow keys move, + and − zoom, 0 fits.`),Ra.show(n),To(r),e(`gain-now`).textContent=``},Ba.start()}async function Io(){let e=await(await fetch(`files.json`)).json();if(!e)return void navigator.serviceWorker?.register(`offline.js`).catch(()=>{});e.hal&&Fo();let t=e.files.map(async(e,t)=>new File([await(await fetch(`files/${t}`)).blob()],e));await io(await Promise.all(t))}async function Lo(){Mo(),ko();for(let[e,{about:t}]of Object.entries(D))qa.append(Object.assign(new Option(e,e),{title:t}));try{await Yi();let t=$.lists=await Wa.ask({task:`lists`});r(Ga,t.machines,t.machine),r(Ka,t.controllers,t.controller),r(Ja,t.controls,t.control),e(`version`).textContent=`feedwright ${t.version}.`;let{example:n,part:i,units:a}=y();jo(a),await Io(),Object.hasOwn(D,n)&&!za.value?await eo(n):i&&!za.value?await to(i):!za.value&&!e(`welcome`).hidden?await O(Wa,eo):$.checked||await co()}catch(e){_o(`The engine does not start: ${e.message}. Load the page again.`)}Wa.cancel()}Object.assign(globalThis,{feedwright:{view:Q}}),Lo();