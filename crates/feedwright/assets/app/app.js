var e=document.createElement(`span`);e.hidden=!0,document.body.append(e);function t(t){return e.style.color=`var(${t})`,getComputedStyle(e).color}var n=()=>matchMedia(`(prefers-color-scheme: dark)`).matches,r=[[104,148,205],[127,143,208],[138,104,186],[141,63,159],[124,18,119],[62,0,66]],i=[[74,110,184],[44,128,160],[38,158,140],[74,190,110],[160,218,57],[253,231,37]];function a(e){let t=n()?i:r,a=Math.min(1,Math.max(0,e))*(t.length-1),o=Math.min(t.length-2,Math.floor(a)),s=a-o;return`rgb(${t[o].map((e,n)=>Math.round(e+s*(t[o+1][n]-e))).join(`,`)})`}var o=!0,s=`uplot`,c=`u-hz`,l=`u-vt`,u=`u-title`,d=`u-wrap`,f=`u-under`,p=`u-over`,m=`u-axis`,h=`u-off`,g=`u-select`,_=`u-cursor-x`,v=`u-cursor-y`,y=`u-cursor-pt`,b=`u-legend`,x=`u-live`,S=`u-inline`,C=`u-series`,w=`u-marker`,T=`u-label`,E=`u-value`,ee=`width`,D=`height`,te=`top`,ne=`bottom`,re=`left`,ie=`right`,ae=`#000`,oe=`#0000`,se=`mousemove`,ce=`mousedown`,le=`mouseup`,ue=`mouseenter`,de=`mouseleave`,fe=`dblclick`,pe=`resize`,me=`scroll`,O=`change`,he=`dppxchange`,ge=`--`,k=typeof window<`u`,_e=k?document:null,ve=k?window:null,ye=k?navigator:null,A,be;function xe(){let e=devicePixelRatio;A!=e&&(A=e,be&&Pe(O,be,xe),be=matchMedia(`(min-resolution: ${A-.001}dppx) and (max-resolution: ${A+.001}dppx)`),Ne(O,be,xe),ve.dispatchEvent(new CustomEvent(he)))}function Se(e,t){if(t!=null){let n=e.classList;!n.contains(t)&&n.add(t)}}function Ce(e,t){let n=e.classList;n.contains(t)&&n.remove(t)}function j(e,t,n){e.style[t]=n+`px`}function we(e,t,n,r){let i=_e.createElement(e);return t!=null&&Se(i,t),n?.insertBefore(i,r),i}function Te(e,t){return we(`div`,e,t)}var Ee=new WeakMap;function De(e,t,n,r,i){let a=`translate(`+t+`px,`+n+`px)`;a!=Ee.get(e)&&(e.style.transform=a,Ee.set(e,a),t<0||n<0||t>r||n>i?Se(e,h):Ce(e,h))}var Oe=new WeakMap;function ke(e,t,n){let r=t+n;r!=Oe.get(e)&&(Oe.set(e,r),e.style.background=t,e.style.borderColor=n)}var Ae=new WeakMap;function je(e,t,n,r){let i=t+``+n;i!=Ae.get(e)&&(Ae.set(e,i),e.style.height=n+`px`,e.style.width=t+`px`,e.style.marginLeft=r?-t/2+`px`:0,e.style.marginTop=r?-n/2+`px`:0)}var M={passive:!0},Me={...M,capture:!0};function Ne(e,t,n,r){t.addEventListener(e,n,r?Me:M)}function Pe(e,t,n,r){t.removeEventListener(e,n,M)}k&&xe();function Fe(e,t,n,r){let i;n||=0,r||=t.length-1;let a=r<=2147483647;for(;r-n>1;)i=a?n+r>>1:L((n+r)/2),t[i]<e?n=i:r=i;return e-t[n]<=t[r]-e?n:r}function N(e){return(t,n,r)=>{let i=-1,a=-1;for(let a=n;a<=r;a++)if(e(t[a])){i=a;break}for(let i=r;i>=n;i--)if(e(t[i])){a=i;break}return[i,a]}}var Ie=e=>e!=null,P=e=>e!=null&&e>0,Le=N(Ie),Re=N(P);function ze(e,t,n,r=0,i=!1){let a=i?Re:Le,o=i?P:Ie;[t,n]=a(e,t,n);let s=e[t],c=e[t];if(t>-1){if(r==1)s=e[t],c=e[n];else if(r==-1)s=e[n],c=e[t];else for(let r=t;r<=n;r++){let t=e[r];o(t)&&(t<s?s=t:t>c&&(c=t))}}return[s??R,c??-R]}function Be(e,t,n,r){let i=it(e),a=it(t);e==t&&(i==-1?(e*=n,t/=n):(e/=n,t*=n));let o=n==10?at:ot,s=i==1?L:et,c=a==1?et:L,l=s(o(Qe(e))),u=c(o(Qe(t))),d=rt(n,l),f=rt(n,u);return n==10&&(l<0&&(d=H(d,-l)),u<0&&(f=H(f,-u))),r||n==2?(e=d*i,t=f*a):(e=bt(e,d),t=V(t,f)),[e,t]}function Ve(e,t,n,r){let i=Be(e,t,n,r);return e==0&&(i[0]=0),t==0&&(i[1]=0),i}var He=.1,Ue={mode:3,pad:He},We={pad:0,soft:null,mode:0},Ge={min:We,max:We};function Ke(e,t,n,r){return jt(n)?I(e,t,n):(We.pad=n,We.soft=r?0:null,We.mode=r?3:0,I(e,t,Ge))}function F(e,t){return e??t}function qe(e,t,n){for(t=F(t,0),n=F(n,e.length-1);t<=n;){if(e[t]!=null)return!0;t++}return!1}function I(e,t,n){let r=n.min,i=n.max,a=F(r.pad,0),o=F(i.pad,0),s=F(r.hard,-R),c=F(i.hard,R),l=F(r.soft,R),u=F(i.soft,-R),d=F(r.mode,0),f=F(i.mode,0),p=t-e,m=at(p),h=nt(Qe(e),Qe(t)),g=Qe(at(h)-m);(p<1e-24||g>10)&&(p=0,(e==0||t==0)&&(p=1e-24,d==2&&l!=R&&(a=0),f==2&&u!=-R&&(o=0)));let _=p||h||1e3,v=rt(10,L(at(_))),y=H(bt(e-_*(p==0?e==0?.1:1:a),v/10),24),b=e>=l&&(d==1||d==3&&y<=l||d==2&&y>=l)?l:R,x=nt(s,y<b&&e>=b?b:tt(b,y)),S=H(V(t+_*(p==0?t==0?.1:1:o),v/10),24),C=t<=u&&(f==1||f==3&&S>=u||f==2&&S<=u)?u:-R,w=tt(c,S>C&&t<=C?C:nt(C,S));return x==w&&x==0&&(w=100),[x,w]}var Je=new Intl.NumberFormat(k?ye.language:`en-US`),Ye=e=>Je.format(e),Xe=Math,Ze=Xe.PI,Qe=Xe.abs,L=Xe.floor,$e=Xe.round,et=Xe.ceil,tt=Xe.min,nt=Xe.max,rt=Xe.pow,it=Xe.sign,at=Xe.log10,ot=Xe.log2,st=(e,t=1)=>Xe.sinh(e)*t,ct=(e,t=1)=>Xe.asinh(e/t),R=1/0;function lt(e){return(at((e^e>>31)-(e>>31))|0)+1}function ut(e,t,n){return tt(nt(e,t),n)}function dt(e){return typeof e==`function`}function z(e){return dt(e)?e:()=>e}var ft=()=>{},pt=e=>e,mt=(e,t)=>t,ht=e=>null,gt=e=>!0,_t=(e,t)=>e==t,vt=/\.\d*?(?=9{6,}|0{6,})/gm,B=e=>{if(Ot(e)||xt.has(e))return e;let t=`${e}`,n=t.match(vt);if(n==null)return e;let r=n[0].length-1;if(t.indexOf(`e-`)!=-1){let[e,n]=t.split(`e`);return+`${B(e)}e${n}`}return H(e,r)};function yt(e,t){return B(H(B(e/t))*t)}function V(e,t){return B(et(B(e/t))*t)}function bt(e,t){return B(L(B(e/t))*t)}function H(e,t=0){if(Ot(e))return e;let n=10**t;return $e(e*n*(1+2**-52))/n}var xt=new Map;function St(e){return((``+e).split(`.`)[1]||``).length}function Ct(e,t,n,r){let i=[],a=r.map(St);for(let o=t;o<n;o++){let t=Qe(o),n=H(rt(e,o),t);for(let s=0;s<r.length;s++){let c=e==10?+`${r[s]}e${o}`:r[s]*n,l=(o>=0?0:t)+(o>=a[s]?0:a[s]),u=e==10?c:H(c,l);i.push(u),xt.set(u,l)}}return i}var wt={},Tt=[],Et=[null,null],Dt=Array.isArray,Ot=Number.isInteger,kt=e=>e===void 0;function At(e){return typeof e==`string`}function jt(e){let t=!1;if(e!=null){let n=e.constructor;t=n==null||n==Object}return t}function Mt(e){return typeof e==`object`&&!!e}var Nt=Object.getPrototypeOf(Uint8Array),Pt=`__proto__`;function Ft(e,t=jt){let n;if(Dt(e)){let r=e.find(e=>e!=null);if(Dt(r)||t(r)){n=Array(e.length);for(let r=0;r<e.length;r++)n[r]=Ft(e[r],t)}else n=e.slice()}else if(e instanceof Nt)n=e.slice();else if(t(e)){n={};for(let r in e)r!=Pt&&(n[r]=Ft(e[r],t))}else n=e;return n}function It(e){let t=arguments;for(let n=1;n<t.length;n++){let r=t[n];for(let t in r)t!=Pt&&(jt(e[t])?It(e[t],Ft(r[t])):e[t]=Ft(r[t]))}return e}var Lt=0,Rt=1,zt=2;function Bt(e,t,n){for(let r=0,i,a=-1;r<t.length;r++){let o=t[r];if(o>a){for(i=o-1;i>=0&&e[i]==null;)e[i--]=null;for(i=o+1;i<n&&e[i]==null;)e[a=i++]=null}}}function Vt(e,t){if(Wt(e)){let t=e[0].slice();for(let n=1;n<e.length;n++)t.push(...e[n].slice(1));return Gt(t[0])||(t=Ut(t)),t}let n=new Set;for(let t=0;t<e.length;t++){let r=e[t][0],i=r.length;for(let e=0;e<i;e++)n.add(r[e])}let r=[Array.from(n).sort((e,t)=>e-t)],i=r[0].length,a=new Map;for(let e=0;e<i;e++)a.set(r[0][e],e);for(let n=0;n<e.length;n++){let o=e[n],s=o[0];for(let e=1;e<o.length;e++){let c=o[e],l=Array(i).fill(void 0),u=t?t[n][e]:Rt,d=[];for(let e=0;e<c.length;e++){let t=c[e],n=a.get(s[e]);t===null?u!=Lt&&(l[n]=t,u==zt&&d.push(n)):l[n]=t}Bt(l,d,i),r.push(l)}}return r}var Ht=typeof queueMicrotask>`u`?e=>Promise.resolve().then(e):queueMicrotask;function Ut(e){let t=e[0],n=t.length,r=Array(n);for(let e=0;e<r.length;e++)r[e]=e;r.sort((e,n)=>t[e]-t[n]);let i=[];for(let t=0;t<e.length;t++){let a=e[t],o=Array(n);for(let e=0;e<n;e++)o[e]=a[r[e]];i.push(o)}return i}function Wt(e){let t=e[0][0],n=t.length;for(let r=1;r<e.length;r++){let i=e[r][0];if(i.length!=n)return!1;if(i!=t){for(let e=0;e<n;e++)if(i[e]!=t[e])return!1}}return!0}function Gt(e,t=100){let n=e.length;if(n<=1)return!0;let r=0,i=n-1;for(;r<=i&&e[r]==null;)r++;for(;i>=r&&e[i]==null;)i--;if(i<=r)return!0;let a=nt(1,L((i-r+1)/t));for(let t=e[r],n=r+a;n<=i;n+=a){let r=e[n];if(r!=null){if(r<=t)return!1;t=r}}return!0}var Kt=[`January`,`February`,`March`,`April`,`May`,`June`,`July`,`August`,`September`,`October`,`November`,`December`],qt=[`Sunday`,`Monday`,`Tuesday`,`Wednesday`,`Thursday`,`Friday`,`Saturday`];function Jt(e){return e.slice(0,3)}var Yt=qt.map(Jt),Xt={MMMM:Kt,MMM:Kt.map(Jt),WWWW:qt,WWW:Yt};function Zt(e){return(e<10?`0`:``)+e}function Qt(e){return(e<10?`00`:e<100?`0`:``)+e}var U={YYYY:e=>e.getFullYear(),YY:e=>(e.getFullYear()+``).slice(2),MMMM:(e,t)=>t.MMMM[e.getMonth()],MMM:(e,t)=>t.MMM[e.getMonth()],MM:e=>Zt(e.getMonth()+1),M:e=>e.getMonth()+1,DD:e=>Zt(e.getDate()),D:e=>e.getDate(),WWWW:(e,t)=>t.WWWW[e.getDay()],WWW:(e,t)=>t.WWW[e.getDay()],HH:e=>Zt(e.getHours()),H:e=>e.getHours(),h:e=>{let t=e.getHours();return t==0?12:t>12?t-12:t},AA:e=>e.getHours()>=12?`PM`:`AM`,aa:e=>e.getHours()>=12?`pm`:`am`,a:e=>e.getHours()>=12?`p`:`a`,mm:e=>Zt(e.getMinutes()),m:e=>e.getMinutes(),ss:e=>Zt(e.getSeconds()),s:e=>e.getSeconds(),fff:e=>Qt(e.getMilliseconds())};function $t(e,t){t||=Xt;let n=[],r=/\{([a-z]+)\}|[^{]+/gi,i;for(;i=r.exec(e);)n.push(i[0][0]==`{`?U[i[1]]:i[0]);return e=>{let r=``;for(let i=0;i<n.length;i++)r+=typeof n[i]==`string`?n[i]:n[i](e,t);return r}}var W=new Intl.DateTimeFormat().resolvedOptions().timeZone;function en(e,t){let n;return t==`UTC`||t==`Etc/UTC`?n=new Date(+e+e.getTimezoneOffset()*6e4):t==W?n=e:(n=new Date(e.toLocaleString(`en-US`,{timeZone:t})),n.setMilliseconds(e.getMilliseconds())),n}var tn=e=>e%1==0,nn=[1,2,2.5,5],rn=Ct(10,-32,0,nn),an=Ct(10,0,32,nn),on=an.filter(tn),sn=rn.concat(an),cn=`
`,ln=`{YYYY}`,un=cn+ln,dn=`{M}/{D}`,fn=cn+dn,pn=fn+`/{YY}`,mn=`{aa}`,hn=`{h}:{mm}`+mn,gn=cn+hn,_n=`:{ss}`,G=null;function vn(e){let t=e*1e3,n=t*60,r=n*60,i=r*24,a=i*30,o=i*365,s=(e==1?Ct(10,0,3,nn).filter(tn):Ct(10,-3,0,nn)).concat([t,t*5,t*10,t*15,t*30,n,n*5,n*10,n*15,n*30,r,r*2,r*3,r*4,r*6,r*8,r*12,i,i*2,i*3,i*4,i*5,i*6,i*7,i*8,i*9,i*10,i*15,a,a*2,a*3,a*4,a*6,o,o*2,o*5,o*10,o*25,o*50,o*100]),c=[[o,ln,G,G,G,G,G,G,1],[i*28,`{MMM}`,un,G,G,G,G,G,1],[i,dn,un,G,G,G,G,G,1],[r,`{h}`+mn,pn,G,fn,G,G,G,1],[n,hn,pn,G,fn,G,G,G,1],[t,_n,pn+` `+hn,G,fn+` `+hn,G,gn,G,1],[e,_n+`.{fff}`,pn+` `+hn,G,fn+` `+hn,G,gn,G,1]];function l(t){return(s,c,l,u,d,f)=>{let p=[],m=d>=o,h=d>=a&&d<o,g=t(l),_=H(g*e,3),v=On(g.getFullYear(),m?0:g.getMonth(),h||m?1:g.getDate()),y=H(v*e,3);if(h||m){let n=h?d/a:0,r=m?d/o:0,i=_==y?_:H(On(v.getFullYear()+r,v.getMonth()+n,1)*e,3),s=new Date($e(i/e)),c=s.getFullYear(),l=s.getMonth();for(let a=0;i<=u;a++){let o=On(c+r*a,l+n*a,1),s=o-t(H(o*e,3));i=H((+o+s)*e,3),i<=u&&p.push(i)}}else{let a=d>=i?i:d,o=y+(L(l)-L(_))+V(_-y,a);p.push(o);let m=t(o),h=m.getHours()+m.getMinutes()/n+m.getSeconds()/r,g=d/r,v=f/s.axes[c]._space;for(;o=H(o+d,e==1?0:3),!(o>u);)if(g>1){let e=L(H(h+g,6))%24,n=t(o).getHours()-e;n>1&&(n=-1),o-=n*r,h=(h+g)%24;let i=p[p.length-1];H((o-i)/d,3)*v>=.7&&p.push(o)}else p.push(o)}return p}}return[s,c,l]}var[yn,bn,xn]=vn(1),[Sn,Cn,wn]=vn(.001);Ct(2,-53,53,[1]);function Tn(e,t){return e.map(e=>e.map((n,r)=>r==0||r==8||n==null?n:t(r==1||e[8]==0?n:e[1]+n)))}function En(e,t){return(n,r,i,a,o)=>{let s=t.find(e=>o>=e[0])||t[t.length-1],c,l,u,d,f,p;return r.map(t=>{let n=e(t),r=n.getFullYear(),i=n.getMonth(),a=n.getDate(),o=n.getHours(),m=n.getMinutes(),h=n.getSeconds(),g=r!=c&&s[2]||i!=l&&s[3]||a!=u&&s[4]||o!=d&&s[5]||m!=f&&s[6]||h!=p&&s[7]||s[1];return c=r,l=i,u=a,d=o,f=m,p=h,g(n)})}}function Dn(e,t){let n=$t(t);return(t,r,i,a,o)=>r.map(t=>n(e(t)))}function On(e,t,n){return new Date(e,t,n)}function kn(e,t){return t(e)}var An=`{YYYY}-{MM}-{DD} {h}:{mm}{aa}`;function jn(e,t){return(n,r,i,a)=>a==null?ge:t(e(r))}function Mn(e,t){let n=e.series[t];return n.width?n.stroke(e,t):n.points.width?n.points.stroke(e,t):null}function Nn(e,t){return e.series[t].fill(e,t)}var Pn={show:!0,live:!0,isolate:!1,mount:ft,markers:{show:!0,width:2,stroke:Mn,fill:Nn,dash:`solid`},idx:null,idxs:null,values:[]};function Fn(e,t){let n=e.cursor.points,r=Te(),i=n.size(e,t);j(r,ee,i),j(r,D,i);let a=i/-2;j(r,`marginLeft`,a),j(r,`marginTop`,a);let o=n.width(e,t,i);return o&&j(r,`borderWidth`,o),r}function In(e,t){let n=e.series[t].points;return n._fill||n._stroke}function Ln(e,t){let n=e.series[t].points;return n._stroke||n._fill}function Rn(e,t){return e.series[t].points.size}var zn=[0,0];function Bn(e,t,n){return zn[0]=t,zn[1]=n,zn}function Vn(e,t,n,r=!0){return e=>{e.button!=0||r&&e.target!=t||n(e)}}function Hn(e,t,n,r=!0){return e=>{r&&e.target!=t||n(e)}}var Un={show:!0,x:!0,y:!0,lock:!1,move:Bn,points:{one:!1,show:Fn,size:Rn,width:0,stroke:Ln,fill:In},bind:{mousedown:Vn,mouseup:Vn,click:Vn,dblclick:Vn,mousemove:Hn,mouseleave:Hn,mouseenter:Hn},drag:{setScale:!0,x:!0,y:!1,dist:0,uni:null,click:(e,t)=>{t.stopPropagation(),t.stopImmediatePropagation()},_x:!1,_y:!1},focus:{dist:(e,t,n,r,i)=>r-i,prox:-1,bias:0},hover:{skip:[void 0],prox:null,bias:0},left:-10,top:-10,idx:null,dataIdx:null,idxs:null,event:null},Wn={show:!0,stroke:`rgba(0,0,0,0.07)`,width:2},Gn=It({},Wn,{filter:mt}),Kn=It({},Gn,{size:10}),qn=It({},Wn,{show:!1}),Jn=`12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, "Noto Sans", sans-serif, "Apple Color Emoji", "Segoe UI Emoji", "Segoe UI Symbol", "Noto Color Emoji"`,Yn=`bold `+Jn,Xn=1.5,Zn={show:!0,scale:`x`,stroke:ae,space:50,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:Yn,side:2,grid:Gn,ticks:Kn,border:qn,font:Jn,lineGap:Xn,rotate:0},Qn=`Value`,$n=`Time`,er={show:!0,scale:`x`,auto:!1,sorted:1,min:R,max:-1/0,idxs:[]};function tr(e,t,n,r,i){return t.map(e=>e==null?``:Ye(e))}function nr(e,t,n,r,i,a,o){let s=[],c=xt.get(i)||0;n=o?n:H(V(n,i),c);for(let e=n;e<=r;e=H(e+i,c))s.push(Object.is(e,-0)?0:e);return s}function rr(e,t,n,r,i,a,o){let s=[],c=e.scales[e.axes[t].scale].log;i=rt(c,L((c==10?at:ot)(n))),c==10&&(i=sn[Fe(i,sn)]);let l=n,u=i*c;c==10&&(u=sn[Fe(u,sn)]);do s.push(l),l+=i,c==10&&!xt.has(l)&&(l=H(l,xt.get(i))),l>=u&&(i=l,u=i*c,c==10&&(u=sn[Fe(u,sn)]));while(l<=r);return s}function ir(e,t,n,r,i,a,o){let s=e.scales[e.axes[t].scale].asinh,c=r>s?rr(e,t,nt(s,n),r,i):[s],l=r>=0&&n<=0?[0]:[];return(n<-s?rr(e,t,nt(s,-r),-n,i):[s]).reverse().map(e=>-e).concat(l,c)}var ar=/./,or=/[12357]/,sr=/[125]/,cr=/1/,lr=(e,t,n,r)=>e.map((e,i)=>t==4&&e==0||i%r==0&&n.test(e.toExponential()[+(e<0)])?e:null);function ur(e,t,n,r,i){let a=e.axes[n],o=a.scale,s=e.scales[o],c=e.valToPos,l=a._space,u=c(10,o),d=c(9,o)-u>=l?ar:c(7,o)-u>=l?or:c(5,o)-u>=l?sr:cr;if(d==cr){let e=Qe(c(1,o)-u);if(e<l)return lr(t.slice().reverse(),s.distr,d,et(l/e)).reverse()}return lr(t,s.distr,d,1)}function dr(e,t,n,r,i){let a=e.axes[n],o=a.scale,s=a._space,c=e.valToPos,l=Qe(c(1,o)-c(2,o));return l<s?lr(t.slice().reverse(),3,ar,et(s/l)).reverse():t}function fr(e,t,n,r){return r==null?ge:t==null?``:Ye(t)}var pr={show:!0,scale:`y`,stroke:ae,space:30,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:Yn,side:3,grid:Gn,ticks:Kn,border:qn,font:Jn,lineGap:Xn,rotate:0};function mr(e,t){return H((3+(e||1)*2)*t,3)}function hr(e,t){let{scale:n,idxs:r}=e.series[0],i=e._data[0],a=e.valToPos(i[r[0]],n,!0),o=Qe(e.valToPos(i[r[1]],n,!0)-a)/(e.series[t].points.space*A);return r[1]-r[0]<=o}var gr={scale:null,auto:!0,sorted:0,min:R,max:-1/0},_r=(e,t,n,r,i)=>i,vr={show:!0,auto:!0,sorted:0,gaps:_r,alpha:1,facets:[It({},gr,{scale:`x`}),It({},gr,{scale:`y`})]},yr={scale:`y`,auto:!0,sorted:0,show:!0,spanGaps:!1,gaps:_r,alpha:1,points:{show:hr,filter:null},values:null,min:R,max:-1/0,idxs:[],path:null,clip:null};function br(e,t,n,r,i){return n/10}var xr={time:o,auto:!0,distr:1,log:10,asinh:1,min:null,max:null,dir:1,ori:0},Sr=It({},xr,{time:!1,ori:1}),Cr={};function wr(e,t){let n=Cr[e];return n||(n={key:e,plots:[],sub(e){n.plots.push(e)},unsub(e){n.plots=n.plots.filter(t=>t!=e)},pub(e,t,r,i,a,o,s){for(let c=0;c<n.plots.length;c++)n.plots[c]!=t&&n.plots[c].pub(e,t,r,i,a,o,s)}},e!=null&&(Cr[e]=n)),n}var Tr=1,Er=2;function Dr(e,t,n){let r=e.mode,i=e.series[t],a=r==2?e._data[t]:e._data,o=e.scales,s=e.bbox,c=a[0],l=r==2?a[1]:a[t],u=r==2?o[i.facets[0].scale]:o[e.series[0].scale],d=r==2?o[i.facets[1].scale]:o[i.scale],f=s.left,p=s.top,m=s.width,h=s.height,g=e.valToPosH,_=e.valToPosV;return u.ori==0?n(i,c,l,u,d,g,_,f,p,m,h,Ir,Rr,Br,Hr,Wr):n(i,c,l,u,d,_,g,p,f,h,m,Lr,zr,Vr,Ur,Gr)}function Or(e,t){let n=0,r=0,i=F(e.bands,Tt);for(let e=0;e<i.length;e++){let a=i[e];a.series[0]==t?n=a.dir:a.series[1]==t&&(a.dir==1?r|=1:r|=2)}return[n,r==1?-1:r==2?1:r==3?2:0]}function kr(e,t,n,r,i){let a=e.mode,o=e.series[t],s=a==2?o.facets[1].scale:o.scale,c=e.scales[s];return i==-1?c.min:i==1?c.max:c.distr==3?c.dir==1?c.min:c.max:0}function Ar(e,t,n,r,i,a){return Dr(e,t,(e,t,o,s,c,l,u,d,f,p,m)=>{let h=e.pxRound,g=s.dir*(s.ori==0?1:-1),_=s.ori==0?Rr:zr,v,y;g==1?(v=n,y=r):(v=r,y=n);let b=h(l(t[v],s,p,d)),x=h(u(o[v],c,m,f)),S=h(l(t[y],s,p,d)),C=h(u(a==1?c.max:c.min,c,m,f)),w=new Path2D(i);return _(w,S,C),_(w,b,C),_(w,b,x),w})}function jr(e,t,n,r,i,a){let o=null;if(e.length>0){o=new Path2D;let s=t==0?Br:Vr,c=n;for(let t=0;t<e.length;t++){let n=e[t];if(n[1]>n[0]){let e=n[0]-c;e>0&&s(o,c,r,e,r+a),c=n[1]}}let l=n+i-c;l>0&&s(o,c,r-5,l,r+a+10)}return o}function Mr(e,t,n){let r=e[e.length-1];r&&r[0]==t?r[1]=n:e.push([t,n])}function Nr(e,t,n,r,i,a,o){let s=[],c=e.length;for(let l=i==1?n:r;l>=n&&l<=r;l+=i)if(t[l]===null){let u=l,d=l;if(i==1)for(;++l<=r&&t[l]===null;)d=l;else for(;--l>=n&&t[l]===null;)d=l;let f=a(e[u]),p=d==u?f:a(e[d]),m=u-i;f=o<=0&&m>=0&&m<c?a(e[m]):f;let h=d+i;p=o>=0&&h>=0&&h<c?a(e[h]):p,p>=f&&s.push([f,p])}return s}function Pr(e){return e==0?pt:e==1?$e:t=>yt(t,e)}function Fr(e){let t=e==0?Ir:Lr,n=e==0?(e,t,n,r,i,a)=>{e.arcTo(t,n,r,i,a)}:(e,t,n,r,i,a)=>{e.arcTo(n,t,i,r,a)},r=e==0?(e,t,n,r,i)=>{e.rect(t,n,r,i)}:(e,t,n,r,i)=>{e.rect(n,t,i,r)};return(e,i,a,o,s,c=0,l=0)=>{c==0&&l==0?r(e,i,a,o,s):(c=tt(c,o/2,s/2),l=tt(l,o/2,s/2),t(e,i+c,a),n(e,i+o,a,i+o,a+s,c),n(e,i+o,a+s,i,a+s,l),n(e,i,a+s,i,a,l),n(e,i,a,i+o,a,c),e.closePath())}}var Ir=(e,t,n)=>{e.moveTo(t,n)},Lr=(e,t,n)=>{e.moveTo(n,t)},Rr=(e,t,n)=>{e.lineTo(t,n)},zr=(e,t,n)=>{e.lineTo(n,t)},Br=Fr(0),Vr=Fr(1),Hr=(e,t,n,r,i,a)=>{e.arc(t,n,r,i,a)},Ur=(e,t,n,r,i,a)=>{e.arc(n,t,r,i,a)},Wr=(e,t,n,r,i,a,o)=>{e.bezierCurveTo(t,n,r,i,a,o)},Gr=(e,t,n,r,i,a,o)=>{e.bezierCurveTo(n,t,i,r,o,a)};function Kr(e){return(e,t,n,r,i)=>Dr(e,t,(t,a,o,s,c,l,u,d,f,p,m)=>{let{pxRound:h,points:g}=t,_,v;s.ori==0?(_=Ir,v=Hr):(_=Lr,v=Ur);let y=H(g.width*A,3),b=(g.size-g.width)/2*A,x=H(b*2,3),S=new Path2D,C=new Path2D,{left:w,top:T,width:E,height:ee}=e.bbox;Br(C,w-x,T-x,E+x*2,ee+x*2);let D=e=>{if(o[e]!=null){let t=h(l(a[e],s,p,d)),n=h(u(o[e],c,m,f));_(S,t+b,n),v(S,t,n,b,0,Ze*2)}};if(i)i.forEach(D);else for(let e=n;e<=r;e++)D(e);return{stroke:y>0?S:null,fill:S,clip:C,flags:3}})}function qr(e){return(t,n,r,i,a,o)=>{r!=i&&(a!=r&&o!=r&&e(t,n,r),a!=i&&o!=i&&e(t,n,i),e(t,n,o))}}var Jr=qr(Rr),Yr=qr(zr);function Xr(e){let t=F(e?.alignGaps,0);return(e,n,r,i)=>Dr(e,n,(a,o,s,c,l,u,d,f,p,m,h)=>{[r,i]=Le(s,r,i);let g=a.pxRound,_=e=>g(u(e,c,m,f)),v=e=>g(d(e,l,h,p)),y,b;c.ori==0?(y=Rr,b=Jr):(y=zr,b=Yr);let x=c.dir*(c.ori==0?1:-1),S={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Tr},C=S.stroke,w=!1;if(i-r>=m*4){let t=t=>e.posToVal(t,c.key,!0),n=null,a=null,l,u,d,f=_(o[x==1?r:i]),p=_(o[r]),m=_(o[i]),h=t(x==1?p+1:m-1);for(let e=x==1?r:i;e>=r&&e<=i;e+=x){let r=o[e],i=(x==1?r<h:r>h)?f:_(r),c=s[e];i==f?c==null?c===null&&(w=!0):(u=c,n==null?(y(C,i,v(u)),l=n=a=u):u<n?n=u:u>a&&(a=u)):(n!=null&&b(C,f,v(n),v(a),v(l),v(u)),c==null?(n=a=null,c===null&&(w=!0)):(u=c,y(C,i,v(u)),n=a=l=u),f=i,h=t(f+x))}n!=null&&n!=a&&d!=f&&b(C,f,v(n),v(a),v(l),v(u))}else for(let e=x==1?r:i;e>=r&&e<=i;e+=x){let t=s[e];t===null?w=!0:t!=null&&y(C,_(o[e]),v(t))}let[T,E]=Or(e,n);if(a.fill!=null||T!=0){let t=S.fill=new Path2D(C),s=v(a.fillTo(e,n,a.min,a.max,T)),c=_(o[r]),l=_(o[i]);x==-1&&([l,c]=[c,l]),y(t,l,s),y(t,c,s)}if(!a.spanGaps){let l=[];w&&l.push(...Nr(o,s,r,i,x,_,t)),S.gaps=l=a.gaps(e,n,r,i,l),S.clip=jr(l,c.ori,f,p,m,h)}return E!=0&&(S.band=E==2?[Ar(e,n,r,i,C,-1),Ar(e,n,r,i,C,1)]:Ar(e,n,r,i,C,E)),S})}function Zr(e){let t=F(e.align,1),n=F(e.ascDesc,!1),r=F(e.alignGaps,0),i=F(e.extend,!1);return(e,a,o,s)=>Dr(e,a,(c,l,u,d,f,p,m,h,g,_,v)=>{[o,s]=Le(u,o,s);let y=c.pxRound,{left:b,width:x}=e.bbox,S=e=>y(p(e,d,_,h)),C=e=>y(m(e,f,v,g)),w=d.ori==0?Rr:zr,T={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Tr},E=T.stroke,ee=d.dir*(d.ori==0?1:-1),D=C(u[ee==1?o:s]),te=S(l[ee==1?o:s]),ne=te,re=te;i&&t==-1&&(re=b,w(E,re,D)),w(E,te,D);for(let e=ee==1?o:s;e>=o&&e<=s;e+=ee){let n=u[e];if(n==null)continue;let r=S(l[e]),i=C(n);t==1?w(E,r,D):w(E,ne,i),w(E,r,i),D=i,ne=r}let ie=ne;i&&t==1&&(ie=b+x,w(E,ie,D));let[ae,oe]=Or(e,a);if(c.fill!=null||ae!=0){let t=T.fill=new Path2D(E),n=C(c.fillTo(e,a,c.min,c.max,ae));w(t,ie,n),w(t,re,n)}if(!c.spanGaps){let i=[];i.push(...Nr(l,u,o,s,ee,S,r));let f=c.width*A/2,p=n||t==1?f:-f,m=n||t==-1?-f:f;i.forEach(e=>{e[0]+=p,e[1]+=m}),T.gaps=i=c.gaps(e,a,o,s,i),T.clip=jr(i,d.ori,h,g,_,v)}return oe!=0&&(T.band=oe==2?[Ar(e,a,o,s,E,-1),Ar(e,a,o,s,E,1)]:Ar(e,a,o,s,E,oe)),T})}function Qr(e,t,n,r,i,a,o=R){if(e.length>1){let s=null;for(let c=0,l=1/0;c<e.length;c++)if(t[c]!==void 0){if(s!=null){let t=Qe(e[c]-e[s]);t<l&&(l=t,o=Qe(n(e[c],r,i,a)-n(e[s],r,i,a)))}s=c}}return o}function $r(e){e||=wt;let t=F(e.size,[.6,R,1]),n=e.align||0,r=e.gap||0,i=e.radius;i=i==null?[0,0]:typeof i==`number`?[i,0]:i;let a=z(i),o=1-t[0],s=F(t[1],R),c=F(t[2],1),l=F(e.disp,wt),u=F(e.each,e=>{}),{fill:d,stroke:f}=l;return(e,t,i,p)=>Dr(e,t,(m,h,g,_,v,y,b,x,S,C,w)=>{let T=m.pxRound,E=n,ee=r*A,D=s*A,te=c*A,ne,re;_.ori==0?[ne,re]=a(e,t):[re,ne]=a(e,t);let ie=_.dir*(_.ori==0?1:-1),ae=_.ori==0?Br:Vr,oe=_.ori==0?u:(e,t,n,r,i,a,o)=>{u(e,t,n,i,r,o,a)},se=F(e.bands,Tt).find(e=>e.series[0]==t),ce=se==null?0:se.dir,le=m.fillTo(e,t,m.min,m.max,ce),ue=T(b(le,v,w,S)),de,fe,pe,me=C,O=T(m.width*A),he=!1,ge=null,k=null,_e=null,ve=null;d!=null&&(O==0||f!=null)&&(he=!0,ge=d.values(e,t,i,p),k=new Map,new Set(ge).forEach(e=>{e!=null&&k.set(e,new Path2D)}),O>0&&(_e=f.values(e,t,i,p),ve=new Map,new Set(_e).forEach(e=>{e!=null&&ve.set(e,new Path2D)})));let{x0:ye,size:be}=l;if(ye!=null&&be!=null){E=1,h=ye.values(e,t,i,p),ye.unit==2&&(h=h.map(t=>e.posToVal(x+t*C,_.key,!0)));let n=be.values(e,t,i,p);fe=be.unit==2?n[0]*C:y(n[0],_,C,x)-y(0,_,C,x),me=Qr(h,g,y,_,C,x,me),pe=me-fe+ee}else me=Qr(h,g,y,_,C,x,me),pe=me*o+ee,fe=me-pe;pe<1&&(pe=0),O>=fe/2&&(O=0),pe<5&&(T=pt);let xe=pe>0,Se=me-pe-(xe?O:0);fe=T(ut(Se,te,D)),de=(E==0?fe/2:E==ie?0:fe)-E*ie*((E==0?ee/2:0)+(xe?O/2:0));let Ce={stroke:null,fill:null,clip:null,band:null,gaps:null,flags:0},j=he?null:new Path2D,we=null;if(se!=null)we=e.data[se.series[1]];else{let{y0:n,y1:r}=l;n!=null&&r!=null&&(g=r.values(e,t,i,p),we=n.values(e,t,i,p))}let Te=ne*fe,Ee=re*fe;for(let n=ie==1?i:p;n>=i&&n<=p;n+=ie){let r=g[n];if(r==null)continue;if(we!=null){let e=we[n]??0;if(r-e==0)continue;ue=b(e,v,w,S)}let i=y(_.distr!=2||l!=null?h[n]:n,_,C,x),a=b(F(r,le),v,w,S),o=T(i-de),s=T(nt(a,ue)),c=T(tt(a,ue)),u=s-c;if(r!=null){let i=r<0?Ee:Te,a=r<0?Te:Ee;he?(O>0&&_e[n]!=null&&ae(ve.get(_e[n]),o,c+L(O/2),fe,nt(0,u-O),i,a),ge[n]!=null&&ae(k.get(ge[n]),o,c+L(O/2),fe,nt(0,u-O),i,a)):ae(j,o,c+L(O/2),fe,nt(0,u-O),i,a),oe(e,t,n,o-O/2,c,fe+O,u)}}return O>0?Ce.stroke=he?ve:j:he||(Ce._fill=m.width==0?m._fill:m._stroke??m._fill,Ce.width=0),Ce.fill=he?k:j,Ce})}function ei(e,t){let n=F(t?.alignGaps,0);return(t,r,i,a)=>Dr(t,r,(o,s,c,l,u,d,f,p,m,h,g)=>{[i,a]=Le(c,i,a);let _=o.pxRound,v=e=>_(d(e,l,h,p)),y=e=>_(f(e,u,g,m)),b,x,S;l.ori==0?(b=Ir,S=Rr,x=Wr):(b=Lr,S=zr,x=Gr);let C=l.dir*(l.ori==0?1:-1),w=v(s[C==1?i:a]),T=w,E=[],ee=[];for(let e=C==1?i:a;e>=i&&e<=a;e+=C)if(c[e]!=null){let t=s[e],n=v(t);E.push(T=n),ee.push(y(c[e]))}let D={stroke:e(E,ee,b,S,x,_),fill:null,clip:null,band:null,gaps:null,flags:Tr},te=D.stroke,[ne,re]=Or(t,r);if(o.fill!=null||ne!=0){let e=D.fill=new Path2D(te),n=y(o.fillTo(t,r,o.min,o.max,ne));S(e,T,n),S(e,w,n)}if(!o.spanGaps){let e=[];e.push(...Nr(s,c,i,a,C,v,n)),D.gaps=e=o.gaps(t,r,i,a,e),D.clip=jr(e,l.ori,p,m,h,g)}return re!=0&&(D.band=re==2?[Ar(t,r,i,a,te,-1),Ar(t,r,i,a,te,1)]:Ar(t,r,i,a,te,re)),D})}function ti(e){return ei(ni,e)}function ni(e,t,n,r,i,a){let o=e.length;if(o<2)return null;let s=new Path2D;if(n(s,e[0],t[0]),o==2)r(s,e[1],t[1]);else{let n=Array(o),r=Array(o-1),a=Array(o-1),c=Array(o-1);for(let n=0;n<o-1;n++)a[n]=t[n+1]-t[n],c[n]=e[n+1]-e[n],r[n]=a[n]/c[n];n[0]=r[0];for(let e=1;e<o-1;e++)r[e]===0||r[e-1]===0||r[e-1]>0!=r[e]>0?n[e]=0:(n[e]=3*(c[e-1]+c[e])/((2*c[e]+c[e-1])/r[e-1]+(c[e]+2*c[e-1])/r[e]),isFinite(n[e])||(n[e]=0));n[o-1]=r[o-2];for(let r=0;r<o-1;r++)i(s,e[r]+c[r]/3,t[r]+n[r]*c[r]/3,e[r+1]-c[r]/3,t[r+1]-n[r+1]*c[r]/3,e[r+1],t[r+1])}return s}var ri=new Set;function ii(){for(let e of ri)e.syncRect(!0)}k&&(Ne(pe,ve,ii),Ne(me,ve,ii,!0),Ne(he,ve,()=>{bi.pxRatio=A}));var ai=Xr(),oi=Kr();function si(e,t,n,r){return(r?[e[0],e[1]].concat(e.slice(2)):[e[0]].concat(e.slice(1))).map((e,r)=>li(e,r,t,n))}function ci(e,t){return e.map((e,n)=>n==0?{}:It({},t,e))}function li(e,t,n,r){return It({},t==0?n:r,e)}function ui(e,t,n){return t==null?Et:[t,n]}var di=ui;function fi(e,t,n){return t==null?Et:Ke(t,n,He,!0)}function pi(e,t,n,r){return t==null?Et:Be(t,n,e.scales[r].log,!1)}var mi=pi;function hi(e,t,n,r){return t==null?Et:Ve(t,n,e.scales[r].log,!1)}var gi=hi;function _i(e,t,n,r,i){let a=nt(lt(e),lt(t)),o=t-e,s=Fe(i/r*o,n);do{let e=n[s],t=r*e/o;if(t>=i&&a+(e<5?xt.get(e):0)<=17)return[e,t]}while(++s<n.length);return[0,0]}function vi(e){let t,n;return e=e.replace(/(\d+)px/,(e,r)=>(t=$e((n=+r)*A))+`px`),[e,t,n]}function yi(e){e.show&&[e.font,e.labelFont].forEach(e=>{let t=H(e[2]*A,1);e[0]=e[0].replace(/[0-9.]+px/,t+`px`),e[1]=t})}function bi(e,t,n){let r={mode:F(e.mode,1)},i=r.mode;function a(e,t,n,r){let i=t.valToPct(e);return r+n*(t.dir==-1?1-i:i)}function o(e,t,n,r){let i=t.valToPct(e);return r+n*(t.dir==-1?i:1-i)}function ae(e,t,n,r){return t.ori==0?a(e,t,n,r):o(e,t,n,r)}r.valToPosH=a,r.valToPosV=o;let pe=!1;r.status=0;let me=r.root=Te(s);if(e.id!=null&&(me.id=e.id),Se(me,e.class),e.title){let t=Te(u,me);t.textContent=e.title}let O=we(`canvas`),k=r.ctx=O.getContext(`2d`),ye=Te(d,me);Ne(`click`,ye,e=>{e.target===xe&&(K!=Li||q!=Ri)&&Hi.click(r,e)},!0);let be=r.under=Te(f,ye);ye.appendChild(O);let xe=r.over=Te(p,ye);e=Ft(e);let Ee=+F(e.pxAlign,1),Oe=Pr(Ee);(e.plugins||[]).forEach(t=>{t.opts&&(e=t.opts(r,e)||e)});let Ae=e.ms||.001,M=r.series=i==1?si(e.series||[],er,yr,!1):ci(e.series||[null],vr),Me=r.axes=si(e.axes||[],Zn,pr,!0),N=r.scales={},Ie=r.bands=e.bands||[];Ie.forEach(e=>{e.fill=z(e.fill||null),e.dir=F(e.dir,-1)});let P=i==2?M[1].facets[0].scale:M[0].scale,Le={axes:xi,series:Jr},Re=(e.drawOrder||[`axes`,`series`]).map(e=>Le[e]);function We(e){let t=e.distr==3?t=>at(t>0?t:e.clamp(r,t,e.min,e.max,e.key)):e.distr==4?t=>ct(t,e.asinh):e.distr==100?t=>e.fwd(t):e=>e;return n=>{let r=t(n),{_min:i,_max:a}=e,o=a-i;return(r-i)/o}}function Ge(t){let n=N[t];if(n==null){let r=(e.scales||wt)[t]||wt;if(r.from!=null){Ge(r.from);let e=It({},N[r.from],r,{key:t});e.valToPct=We(e),N[t]=e}else{n=N[t]=It({},t==P?xr:Sr,r),n.key=t;let e=n.time,a=n.range,o=Dt(a);if((t!=P||i==2&&!e)&&(o&&(a[0]==null||a[1]==null)&&(a={min:a[0]==null?Ue:{mode:1,hard:a[0],soft:a[0]},max:a[1]==null?Ue:{mode:1,hard:a[1],soft:a[1]}},o=!1),!o&&jt(a))){let e=a;a=(t,n,r)=>n==null?Et:Ke(n,r,e)}n.range=z(a||(e?di:t==P?n.distr==3?mi:n.distr==4?gi:ui:n.distr==3?pi:n.distr==4?hi:fi)),n.auto=z(!o&&n.auto),n.clamp=z(n.clamp||br),n._min=n._max=null,n.valToPct=We(n)}}}Ge(`x`),Ge(`y`),i==1&&M.forEach(e=>{Ge(e.scale)}),Me.forEach(e=>{Ge(e.scale)});for(let t in e.scales)Ge(t);let I=N[P],Je=I.distr,Ye,Xe;I.ori==0?(Se(me,c),Ye=a,Xe=o):(Se(me,l),Ye=o,Xe=a);let L={};for(let e in N){let t=N[e];(t.min!=null||t.max!=null)&&(L[e]={min:t.min,max:t.max},t.min=t.max=null)}let it=e.tzDate||(e=>new Date($e(e/Ae))),ot=e.fmtDate||$t,lt=Ae==1?xn(it):wn(it),ft=En(it,Tn(Ae==1?bn:Cn,ot)),pt=jn(it,kn(An,ot)),vt=[],B=r.legend=It({},Pn,e.legend),V=r.cursor=It({},Un,{drag:{y:i==2}},e.cursor),bt=B.show,Ct=V.show,Ot=B.markers;B.idxs=vt,Ot.width=z(Ot.width),Ot.dash=z(Ot.dash),Ot.stroke=z(Ot.stroke),Ot.fill=z(Ot.fill);let Nt,Pt,Lt,Rt=[],zt=[],Bt,Vt=!1,Ut={};if(B.live){let e=M[1]?M[1].values:null;Vt=e!=null,Bt=Vt?e(r,1,0):{_:0};for(let e in Bt)Ut[e]=ge}if(bt){if(Nt=we(`table`,b,me),Lt=we(`tbody`,null,Nt),B.mount(r,Nt),Vt){Pt=we(`thead`,null,Nt,Lt);let e=we(`tr`,null,Pt);for(var Wt in we(`th`,null,e),Bt)we(`th`,T,e).textContent=Wt}else Se(Nt,S),B.live&&Se(Nt,x)}let Gt={show:!0},Kt={show:!1};function qt(e,t){if(t==0&&(Vt||!B.live||i==2))return Et;let n=[],a=we(`tr`,C,Lt,Lt.childNodes[t]);Se(a,e.class),e.show||Se(a,h);let o=we(`th`,null,a);if(Ot.show){let e=Te(w,o);if(t>0){let n=Ot.width(r,t);n&&(e.style.border=n+`px `+Ot.dash(r,t)+` `+Ot.stroke(r,t)),e.style.background=Ot.fill(r,t)}}let s=Te(T,o);for(var c in e.label instanceof HTMLElement?s.appendChild(e.label):s.textContent=e.label,t>0&&(Ot.show||(s.style.color=e.width>0?Ot.stroke(r,t):Ot.fill(r,t)),Yt(`click`,o,t=>{if(V._lock)return;Ln(t);let n=M.indexOf(e);if((t.ctrlKey||t.metaKey)!=B.isolate){let e=M.some((e,t)=>t>0&&t!=n&&e.show);M.forEach((t,r)=>{r>0&&X(r,e?r==n?Gt:Kt:Gt,!0,$.setSeries)})}else X(n,{show:!e.show},!0,$.setSeries)},!1),Bn&&Yt(ue,o,t=>{V._lock||(Ln(t),X(M.indexOf(e),ta,!0,$.setSeries))},!1)),Bt){let e=we(`td`,E,a);e.textContent=`--`,n.push(e)}return[a,n]}let Jt=new Map;function Yt(e,t,n,i=!0){let a=Jt.get(t)||{},o=V.bind[e](r,t,n,i);o&&(Ne(e,t,a[e]=o),Jt.set(t,a))}function Xt(e,t,n){let r=Jt.get(t)||{};for(let n in r)(e==null||n==e)&&(Pe(n,t,r[n]),delete r[n]);e??Jt.delete(t)}let Zt=0,Qt=0,U=0,W=0,en=0,tn=0,nn=en,rn=tn,an=U,cn=W,ln=0,un=0,dn=0,fn=0;r.bbox={};let pn=!1,mn=!1,hn=!1,gn=!1,_n=!1,G=!1;function vn(e,t,n){(n||e!=r.width||t!=r.height)&&On(e,t),Si(!1),hn=!0,mn=!0,Di()}function On(e,t){r.width=Zt=U=e,r.height=Qt=W=t,en=tn=0,Fn(),In();let n=r.bbox;ln=n.left=yt(en*A,.5),un=n.top=yt(tn*A,.5),dn=n.width=yt(U*A,.5),fn=n.height=yt(W*A,.5)}function Mn(){let e=!1,t=0;for(;!e;){t++;let n=ii(t),i=bi(t);e=t==3||n&&i,e||(On(r.width,r.height),mn=!0)}}function Nn({width:e,height:t}){vn(e,t)}r.setSize=Nn;function Fn(){let e=!1,t=!1,n=!1,r=!1;Me.forEach((i,a)=>{if(i.show&&i._show){let{side:a,_size:o}=i,s=a%2,c=o+(i.label==null?0:i.labelSize);c>0&&(s?(U-=c,a==3?(en+=c,r=!0):n=!0):(W-=c,a==0?(tn+=c,e=!0):t=!0))}}),Xn[0]=e,Xn[1]=n,Xn[2]=t,Xn[3]=r,U-=cr[1]+cr[3],en+=cr[3],W-=cr[2]+cr[0],tn+=cr[0]}function In(){let e=en+U,t=tn+W,n=en,r=tn;function i(i,a){switch(i){case 1:return e+=a,e-a;case 2:return t+=a,t-a;case 3:return n-=a,n+a;case 0:return r-=a,r+a}}Me.forEach((e,t)=>{if(e.show&&e._show){let t=e.side;e._pos=i(t,e._size),e.label!=null&&(e._lpos=i(t,e.labelSize))}})}if(V.dataIdx==null){let e=V.hover,n=e.skip=new Set(e.skip??[]);n.add(void 0);let r=e.prox=z(e.prox),i=e.bias??=0;V.dataIdx=(e,a,o,s)=>{if(a==0)return o;let c=o,l=r(e,a,o,s)??R,u=l>=0&&l<R,d=I.ori==0?U:W,f=V.left,p=t[0],m=t[a];if(n.has(m[o])){c=null;let e=null,t=null,r;if(i==0||i==-1)for(r=o;e==null&&r-->0;)n.has(m[r])||(e=r);if(i==0||i==1)for(r=o;t==null&&r++<m.length;)n.has(m[r])||(t=r);if(e!=null||t!=null){if(u){let n=e==null?-1/0:Ye(p[e],I,d,0),r=t==null?1/0:Ye(p[t],I,d,0),i=f-n,a=r-f;i<=a?i<=l&&(c=e):a<=l&&(c=t)}else c=t==null?e:e==null?t:o-e<=t-o?e:t}}else u&&Qe(f-Ye(p[o],I,d,0))>l&&(c=null);return c}}let Ln=e=>{V.event=e};V.idxs=vt,V._lock=!1;let Rn=V.points;Rn.show=z(Rn.show),Rn.size=z(Rn.size),Rn.stroke=z(Rn.stroke),Rn.width=z(Rn.width),Rn.fill=z(Rn.fill);let zn=r.focus=It({},e.focus||{alpha:.3},V.focus),Bn=zn.prox>=0,Vn=Bn&&Rn.one,Hn=[],Wn=[],Gn=[];function Kn(e,t){let n=Rn.show(r,t);if(n instanceof HTMLElement)return Se(n,y),Se(n,e.class),De(n,-10,-10,U,W),xe.insertBefore(n,Hn[t]),n}function qn(e,t){if(i==1||t>0){let t=i==1&&N[e.scale].time,n=e.value;e.value=t?At(n)?jn(it,kn(n,ot)):n||pt:n||fr,e.label=e.label||(t?$n:Qn)}if(Vn||t>0){e.width=e.width==null?1:e.width,e.paths=e.paths||ai||ht,e.fillTo=z(e.fillTo||kr),e.pxAlign=+F(e.pxAlign,Ee),e.pxRound=Pr(e.pxAlign),e.stroke=z(e.stroke||null),e.fill=z(e.fill||null),e._stroke=e._fill=e._paths=e._focus=null;let t=mr(nt(1,e.width),1),n=e.points=It({},{size:t,width:nt(1,t*.2),stroke:e.stroke,space:t*2,paths:oi,_stroke:null,_fill:null},e.points);n.show=z(n.show),n.filter=z(n.filter),n.fill=z(n.fill),n.stroke=z(n.stroke),n.paths=z(n.paths),n.pxAlign=e.pxAlign}if(bt){let n=qt(e,t);Rt.splice(t,0,n[0]),zt.splice(t,0,n[1]),B.values.push(null)}if(Ct){vt.splice(t,0,null);let n=null;Vn?t==0&&(n=Kn(e,t)):t>0&&(n=Kn(e,t)),Hn.splice(t,0,n),Wn.splice(t,0,0),Gn.splice(t,0,0)}Oa(`addSeries`,t)}function Jn(e,t){t??=M.length,e=i==1?li(e,t,er,yr):li(e,t,{},vr),M.splice(t,0,e),qn(M[t],t)}r.addSeries=Jn;function Yn(e){if(M.splice(e,1),bt){B.values.splice(e,1),zt.splice(e,1);let t=Rt.splice(e,1)[0];Xt(null,t.firstChild),t.remove()}Ct&&(vt.splice(e,1),Hn.splice(e,1)[0].remove(),Wn.splice(e,1),Gn.splice(e,1)),Oa(`delSeries`,e)}r.delSeries=Yn;let Xn=[!1,!1,!1,!1];function ar(e,t){if(e._show=e.show,e.show){let n=e.side%2,i=N[e.scale];i??=(e.scale=n?M[1].scale:P,N[e.scale]);let a=i.time;e.size=z(e.size),e.space=z(e.space),e.rotate=z(e.rotate),Dt(e.incrs)&&e.incrs.forEach(e=>{!xt.has(e)&&xt.set(e,St(e))}),e.incrs=z(e.incrs||(i.distr==2?on:a?Ae==1?yn:Sn:sn)),e.splits=z(e.splits||(a&&i.distr==1?lt:i.distr==3?rr:i.distr==4?ir:nr)),e.stroke=z(e.stroke),e.grid.stroke=z(e.grid.stroke),e.ticks.stroke=z(e.ticks.stroke),e.border.stroke=z(e.border.stroke);let o=e.values;e.values=Dt(o)&&!Dt(o[0])?z(o):a?Dt(o)?En(it,Tn(o,ot)):At(o)?Dn(it,o):o||ft:o||tr,e.filter=z(e.filter||(i.distr>=3&&i.log==10?ur:i.distr==3&&i.log==2?dr:mt)),e.font=vi(e.font),e.labelFont=vi(e.labelFont),e._size=e.size(r,null,t,0),e._space=e._rotate=e._incrs=e._found=e._splits=e._values=null,e._size>0&&(Xn[t]=!0,e._el=Te(m,ye))}}function or(e,t,n,r){let[i,a,o,s]=n,c=t%2,l=0;return c==0&&(s||a)&&(l=t==0&&!i||t==2&&!o?$e(Zn.size/3):0),c==1&&(i||o)&&(l=t==1&&!a||t==3&&!s?$e(pr.size/2):0),l}let sr=r.padding=(e.padding||[or,or,or,or]).map(e=>z(F(e,or))),cr=r._padding=sr.map((e,t)=>e(r,t,Xn,0)),lr,hr=null,gr=null,_r=i==1?M[0].idxs:null,Cr=null,Dr=!1;function Or(e,n){if(t=e??[],r.data=r._data=t,i==2){lr=0;for(let e=1;e<M.length;e++)lr+=t[e][0].length}else{t.length==0&&(r.data=r._data=t=[[]]),Cr=t[0],lr=Cr.length;let e=t;if(Je==2){e=t.slice();let n=e[0]=Array(lr);for(let e=0;e<lr;e++)n[e]=e}r._data=t=e}if(Si(!0),Oa(`setData`),Je==2&&(hn=!0),n!==!1){let e=I;e.auto(r,Dr)?Ar():Y(P,e.min,e.max),gn||=V.left>=0,G=!0,Di()}}r.setData=Or;function Ar(){Dr=!0;let e,n;i==1&&(lr>0?(hr=_r[0]=0,gr=_r[1]=lr-1,e=t[0][hr],n=t[0][gr],Je==2?(e=hr,n=gr):e==n&&(Je==3?[e,n]=Be(e,e,I.log,!1):Je==4?[e,n]=Ve(e,e,I.log,!1):I.time?n=e+$e(86400/Ae):[e,n]=Ke(e,n,He,!0))):(hr=_r[0]=e=null,gr=_r[1]=n=null)),Y(P,e,n)}let jr,Mr,Nr,Fr,Ir,Lr,Rr,zr,Br,Vr;function Hr(e,t,n,r,i,a){e??=oe,n??=Tt,r??=`butt`,i??=oe,a??=`round`,e!=jr&&(k.strokeStyle=jr=e),i!=Mr&&(k.fillStyle=Mr=i),t!=Nr&&(k.lineWidth=Nr=t),a!=Ir&&(k.lineJoin=Ir=a),r!=Lr&&(k.lineCap=Lr=r),n!=Fr&&k.setLineDash(Fr=n)}function Ur(e,t,n,r){t!=Mr&&(k.fillStyle=Mr=t),e!=Rr&&(k.font=Rr=e),n!=zr&&(k.textAlign=zr=n),r!=Br&&(k.textBaseline=Br=r)}function Wr(e,t,n,i,a=0){if(i.length>0&&e.auto(r,Dr)&&(t==null||t.min==null)){let t=F(hr,0),r=F(gr,i.length-1),o=n.min==null?ze(i,t,r,a,e.distr==3):[n.min,n.max];e.min=tt(e.min,n.min=o[0]),e.max=nt(e.max,n.max=o[1])}}let Gr={min:null,max:null};function Kr(){for(let e in N){let t=N[e];L[e]==null&&(t.min==null||L[P]!=null&&t.auto(r,Dr))&&(L[e]=Gr)}for(let e in N){let t=N[e];L[e]==null&&t.from!=null&&L[t.from]!=null&&(L[e]=Gr)}L[P]!=null&&Si(!0);let e={};for(let t in L){let n=L[t];if(n!=null){let a=e[t]=Ft(N[t],Mt);if(n.min!=null)It(a,n);else if(t!=P||i==2){if(lr==0&&a.from==null){let e=a.range(r,null,null,t);a.min=e[0],a.max=e[1]}else a.min=R,a.max=-1/0}}}if(lr>0){M.forEach((n,a)=>{if(i==1){let i=n.scale,o=L[i];if(o==null)return;let s=e[i];if(a==0){let e=s.range(r,s.min,s.max,i);s.min=e[0],s.max=e[1],hr=Fe(s.min,t[0]),gr=Fe(s.max,t[0]),gr-hr>1&&(t[0][hr]<s.min&&hr++,t[0][gr]>s.max&&gr--),n.min=Cr[hr],n.max=Cr[gr]}else n.show&&n.auto&&Wr(s,o,n,t[a],n.sorted);n.idxs[0]=hr,n.idxs[1]=gr}else if(a>0&&n.show&&n.auto){let[r,i]=n.facets,o=r.scale,s=i.scale,[c,l]=t[a],u=e[o],d=e[s];u!=null&&Wr(u,L[o],r,c,r.sorted),d!=null&&Wr(d,L[s],i,l,i.sorted),n.min=i.min,n.max=i.max}});for(let t in e){let n=e[t],i=L[t];if(n.from==null&&(i==null||i.min==null)){let e=n.range(r,n.min==R?null:n.min,n.max==-1/0?null:n.max,t);n.min=e[0],n.max=e[1]}}}for(let t in e){let n=e[t];if(n.from!=null){let i=e[n.from];if(i.min==null)n.min=n.max=null;else{let e=n.range(r,i.min,i.max,t);n.min=e[0],n.max=e[1]}}}let n={},a=!1;for(let t in e){let r=e[t],i=N[t];if(i.min!=r.min||i.max!=r.max){i.min=r.min,i.max=r.max;let e=i.distr;i._min=e==3?at(i.min):e==4?ct(i.min,i.asinh):e==100?i.fwd(i.min):i.min,i._max=e==3?at(i.max):e==4?ct(i.max,i.asinh):e==100?i.fwd(i.max):i.max,n[t]=a=!0}}if(a){M.forEach((e,t)=>{i==2?t>0&&n.y&&(e._paths=null):n[e.scale]&&(e._paths=null)});for(let e in n)hn=!0,Oa(`setScale`,e);Ct&&V.left>=0&&(gn=G=!0)}for(let e in L)L[e]=null}function qr(e){let t=ut(hr-1,0,lr-1),n=ut(gr+1,0,lr-1);for(;e[t]==null&&t>0;)t--;for(;e[n]==null&&n<lr-1;)n++;return[t,n]}function Jr(){if(lr>0){let e=M.some(e=>e._focus)&&Vr!=zn.alpha;e&&(k.globalAlpha=Vr=zn.alpha),M.forEach((e,n)=>{if(n>0&&e.show&&(Yr(n,!1),Yr(n,!0),e._paths==null)){let a=Vr;Vr!=e.alpha&&(k.globalAlpha=Vr=e.alpha);let o=i==2?[0,t[n][0].length-1]:qr(t[n]);e._paths=e.paths(r,n,o[0],o[1]),Vr!=a&&(k.globalAlpha=Vr=a)}}),M.forEach((e,t)=>{if(t>0&&e.show){let n=Vr;Vr!=e.alpha&&(k.globalAlpha=Vr=e.alpha),e._paths!=null&&Xr(t,!1);{let n=e._paths==null?null:e._paths.gaps,i=e.points.show(r,t,hr,gr,n),a=e.points.filter(r,t,i,n);(i||a)&&(e.points._paths=e.points.paths(r,t,hr,gr,a),Xr(t,!0))}Vr!=n&&(k.globalAlpha=Vr=n),Oa(`drawSeries`,t)}}),e&&(k.globalAlpha=Vr=1)}}function Yr(e,t){let n=t?M[e].points:M[e];n._stroke=n.stroke(r,e),n._fill=n.fill(r,e)}function Xr(e,t){let n=t?M[e].points:M[e],{stroke:r,fill:i,clip:a,flags:o,_stroke:s=n._stroke,_fill:c=n._fill,_width:l=n.width}=n._paths;l=H(l*A,3);let u=null,d=l%2/2;t&&c==null&&(c=l>0?`#fff`:s);let f=n.pxAlign==1&&d>0;if(f&&k.translate(d,d),!t){let e=ln-l/2,t=un-l/2,n=dn+l,r=fn+l;u=new Path2D,u.rect(e,t,n,r)}t?Qr(s,l,n.dash,n.cap,c,r,i,o,a):Zr(e,s,l,n.dash,n.cap,c,r,i,o,u,a),f&&k.translate(-d,-d)}function Zr(e,n,i,a,o,s,c,l,u,d,f){let p=!1;u!=0&&Ie.forEach((m,h)=>{if(m.series[0]==e){let e=M[m.series[1]],g=t[m.series[1]],_=(e._paths||wt).band;Dt(_)&&(_=m.dir==1?_[0]:_[1]);let v,y=null;e.show&&_&&qe(g,hr,gr)?(y=m.fill(r,h)||s,v=e._paths.clip):_=null,Qr(n,i,a,o,y,c,l,u,d,f,v,_),p=!0}}),p||Qr(n,i,a,o,s,c,l,u,d,f)}function Qr(e,t,n,r,i,a,o,s,c,l,u,d){Hr(e,t,n,r,i),(c||l||d)&&(k.save(),c&&k.clip(c),l&&k.clip(l)),d?(s&3)==3?(k.clip(d),u&&k.clip(u),ei(i,o),$r(e,a,t)):s&Er?(ei(i,o),k.clip(d),$r(e,a,t)):s&Tr&&(k.save(),k.clip(d),u&&k.clip(u),ei(i,o),k.restore(),$r(e,a,t)):(ei(i,o),$r(e,a,t)),(c||l||d)&&k.restore()}function $r(e,t,n){n>0&&(t instanceof Map?t.forEach((e,t)=>{k.strokeStyle=jr=t,k.stroke(e)}):t!=null&&e&&k.stroke(t))}function ei(e,t){t instanceof Map?t.forEach((e,t)=>{k.fillStyle=Mr=t,k.fill(e)}):t!=null&&e&&k.fill(t)}function ti(e,t,n,i){let a=Me[e],o;if(i<=0)o=[0,0];else{let s=a._space=a.space(r,e,t,n,i);o=_i(t,n,a._incrs=a.incrs(r,e,t,n,i,s),i,s)}return a._found=o}function ni(e,t,n,r,i,a,o,s,c,l){let u=o%2/2;Ee==1&&k.translate(u,u),Hr(s,o,c,l,s),k.beginPath();let d,f,p,m,h=i+(r==0||r==3?-a:a);n==0?(f=i,m=h):(d=i,p=h);for(let r=0;r<e.length;r++)t[r]!=null&&(n==0?d=p=e[r]:f=m=e[r],k.moveTo(d,f),k.lineTo(p,m));k.stroke(),Ee==1&&k.translate(-u,-u)}function ii(e){let t=!0;return Me.forEach((n,i)=>{if(!n.show)return;let a=N[n.scale];if(a.min==null){n._show&&(t=!1,n._show=!1,Si(!1));return}n._show||(t=!1,n._show=!0,Si(!1));let o=n.side,s=o%2,{min:c,max:l}=a,[u,d]=ti(i,c,l,s==0?U:W);if(d==0)return;let f=a.distr==2,p=n._splits=n.splits(r,i,c,l,u,d,f),m=a.distr==2?p.map(e=>Cr[e]):p,h=a.distr==2?Cr[p[1]]-Cr[p[0]]:u,g=n._values=n.values(r,n.filter(r,m,i,d,h),i,d,h);n._rotate=o==2?n.rotate(r,g,i,d):0;let _=n._size;n._size=et(n.size(r,g,i,e)),_!=null&&n._size!=_&&(t=!1)}),t}function bi(e){let t=!0;return sr.forEach((n,i)=>{let a=n(r,i,Xn,e);a!=cr[i]&&(t=!1),cr[i]=a}),t}function xi(){for(let e=0;e<Me.length;e++){let t=Me[e];if(!t.show||!t._show)continue;let n=t.side,i=n%2,a,o,s=t.stroke(r,e),c=n==0||n==3?-1:1,[l,u]=t._found;if(t.label!=null){let d=t.labelGap*c,f=$e((t._lpos+d)*A);Ur(t.labelFont[0],s,`center`,n==2?te:ne),k.save(),i==1?(a=o=0,k.translate(f,$e(un+fn/2)),k.rotate((n==3?-Ze:Ze)/2)):(a=$e(ln+dn/2),o=f);let p=dt(t.label)?t.label(r,e,l,u):t.label;k.fillText(p,a,o),k.restore()}if(u==0)continue;let d=N[t.scale],f=i==0?dn:fn,p=i==0?ln:un,m=t._splits,h=d.distr==2?m.map(e=>Cr[e]):m,g=d.distr==2?Cr[m[1]]-Cr[m[0]]:l,_=t.ticks,v=t.border,y=_.show?_.size:0,b=$e(y*A),x=$e((t.alignTo==2?t._size-y-t.gap:t.gap)*A),S=t._rotate*-Ze/180,C=Oe(t._pos*A),w=C+(b+x)*c;o=i==0?w:0,a=i==1?w:0;let T=t.font[0];Ur(T,s,t.align==1?re:t.align==2?ie:S>0?re:S<0?ie:i==0?`center`:n==3?ie:re,S||i==1?`middle`:n==2?te:ne);let E=t.font[1]*t.lineGap,ee=m.map(e=>Oe(ae(e,d,f,p))),D=t._values;for(let e=0;e<D.length;e++){let t=D[e];if(t!=null){i==0?a=ee[e]:o=ee[e],t=``+t;let n=t.indexOf(`
`)==-1?[t]:t.split(/\n/gm);for(let e=0;e<n.length;e++){let t=n[e];S?(k.save(),k.translate(a,o+e*E),k.rotate(S),k.fillText(t,0,0),k.restore()):k.fillText(t,a,o+e*E)}}}_.show&&ni(ee,_.filter(r,h,e,u,g),i,n,C,b,H(_.width*A,3),_.stroke(r,e),_.dash,_.cap);let oe=t.grid;oe.show&&ni(ee,oe.filter(r,h,e,u,g),i,i==0?2:1,i==0?un:ln,i==0?fn:dn,H(oe.width*A,3),oe.stroke(r,e),oe.dash,oe.cap),v.show&&ni([C],[1],+(i==0),i==0?1:2,i==1?un:ln,i==1?fn:dn,H(v.width*A,3),v.stroke(r,e),v.dash,v.cap)}Oa(`drawAxes`)}function Si(e){M.forEach((t,n)=>{n>0&&(t._paths=null,e&&(i==1?(t.min=null,t.max=null):t.facets.forEach(e=>{e.min=null,e.max=null})))})}let Ci=!1,wi=!1,Ti=[];function Ei(){wi=!1;for(let e=0;e<Ti.length;e++)Oa(...Ti[e]);Ti.length=0}function Di(){Ci||=(Ht(ki),!0)}function Oi(e,t=!1){Ci=!0,wi=t,e(r),ki(),t&&Ti.length>0&&queueMicrotask(Ei)}r.batch=Oi;function ki(){if(pn&&=(Kr(),!1),hn&&=(Mn(),!1),mn){if(j(be,re,en),j(be,te,tn),j(be,ee,U),j(be,D,W),j(xe,re,en),j(xe,te,tn),j(xe,ee,U),j(xe,D,W),j(ye,ee,Zt),j(ye,D,Qt),O.width=$e(Zt*A),O.height=$e(Qt*A),Me.forEach(({_el:e,_show:t,_size:n,_pos:r,side:i})=>{if(e!=null){if(t){let t=i===3||i===0?n:0,a=i%2==1;j(e,a?`left`:`top`,r-t),j(e,a?`width`:`height`,n),j(e,a?`top`:`left`,a?tn:en),j(e,a?`height`:`width`,a?W:U),Ce(e,h)}else Se(e,h)}}),jr=Mr=Nr=Ir=Lr=Rr=zr=Br=Fr=null,Vr=1,pa(!0),en!=nn||tn!=rn||U!=an||W!=cn){Si(!1);let e=U/an,t=W/cn;if(Ct&&!gn&&V.left>=0){V.left*=e,V.top*=t,Ni&&De(Ni,$e(V.left),0,U,W),Pi&&De(Pi,0,$e(V.top),U,W);for(let n=0;n<Hn.length;n++){let r=Hn[n];r!=null&&(Wn[n]*=e,Gn[n]*=t,De(r,et(Wn[n]),et(Gn[n]),U,W))}}if(J.show&&!_n&&J.left>=0&&J.width>0){J.left*=e,J.width*=e,J.top*=t,J.height*=t;for(let e in ga)j(Gi,e,J[e])}nn=en,rn=tn,an=U,cn=W}Oa(`setSize`),mn=!1}Zt>0&&Qt>0&&(k.clearRect(0,0,O.width,O.height),Oa(`drawClear`),Re.forEach(e=>e()),Oa(`draw`)),J.show&&_n&&(Ki(J),_n=!1),Ct&&gn&&(da(null,!0,!1),gn=!1),B.show&&B.live&&G&&(la(),G=!1),pe||(pe=!0,r.status=1,Oa(`ready`)),Dr=!1,Ci=!1}r.redraw=(e,t)=>{hn=t||!1,e===!1?Di():Y(P,I.min,I.max)};function Ai(e,n){let i=N[e];if(i.from==null){if(lr==0){let t=i.range(r,n.min,n.max,e);n.min=t[0],n.max=t[1]}if(n.min>n.max){let e=n.min;n.min=n.max,n.max=e}if(lr>1&&n.min!=null&&n.max!=null&&n.max-n.min<1e-16)return;e==P&&i.distr==2&&lr>0&&(n.min=Fe(n.min,t[0]),n.max=Fe(n.max,t[0]),n.min==n.max&&n.max++),L[e]=n,pn=!0,Di()}}r.setScale=Ai;let ji,Mi,Ni,Pi,Fi,Ii,Li,Ri,zi,Bi,K,q,Vi=!1,Hi=V.drag,Ui=Hi.x,Wi=Hi.y;Ct&&(V.x&&(ji=Te(_,xe)),V.y&&(Mi=Te(v,xe)),I.ori==0?(Ni=ji,Pi=Mi):(Ni=Mi,Pi=ji),K=V.left,q=V.top);let J=r.select=It({show:!0,over:!0,left:0,width:0,top:0,height:0},e.select),Gi=J.show?Te(g,J.over?xe:be):null;function Ki(e,t){if(J.show){for(let t in e)J[t]=e[t],t in ga&&j(Gi,t,e[t]);t!==!1&&Oa(`setSelect`)}}r.setSelect=Ki;function qi(e){if(M[e].show)bt&&Ce(Rt[e],h);else if(bt&&Se(Rt[e],h),Ct){let t=Vn?Hn[0]:Hn[e];t!=null&&De(t,-10,-10,U,W)}}function Y(e,t,n){Ai(e,{min:t,max:n})}function X(e,t,n,a){t.focus!=null&&na(e),t.show!=null&&M.forEach((n,r)=>{r>0&&(e==r||e==null)&&(n.show=t.show,qi(r),i==2?(Y(n.facets[0].scale,null,null),Y(n.facets[1].scale,null,null)):Y(n.scale,null,null),Di())}),n!==!1&&Oa(`setSeries`,e,t),a&&Ma(`setSeries`,r,e,t)}r.setSeries=X;function Ji(e,t){It(Ie[e],t)}function Yi(e,t){e.fill=z(e.fill||null),e.dir=F(e.dir,-1),t??=Ie.length,Ie.splice(t,0,e)}function Xi(e){e==null?Ie.length=0:Ie.splice(e,1)}r.addBand=Yi,r.setBand=Ji,r.delBand=Xi;function Zi(e,t){M[e].alpha=t,Ct&&Hn[e]!=null&&(Hn[e].style.opacity=t),bt&&Rt[e]&&(Rt[e].style.opacity=t)}let Qi,$i,ea,ta={focus:!0};function na(e){if(e!=ea){let t=e==null,n=zn.alpha!=1;M.forEach((r,a)=>{if(i==1||a>0){let i=t||a==0||a==e;r._focus=t?null:i,n&&Zi(a,i?1:zn.alpha)}}),ea=e,n&&Di()}}bt&&Bn&&Yt(de,Nt,e=>{V._lock||(Ln(e),ea!=null&&X(null,ta,!0,$.setSeries))});function ra(e,t,n){let r=N[t];n&&(e=e/A-(r.ori==1?tn:en));let i=U;r.ori==1&&(i=W,e=i-e),r.dir==-1&&(e=i-e);let a=r._min,o=r._max,s=e/i,c=a+(o-a)*s,l=r.distr;return l==3?rt(10,c):l==4?st(c,r.asinh):l==100?r.bwd(c):c}function Z(e,n){return Fe(ra(e,P,n),t[0],hr,gr)}r.valToIdx=e=>Fe(e,t[0]),r.posToIdx=Z,r.posToVal=ra,r.valToPos=(e,t,n)=>N[t].ori==0?a(e,N[t],n?dn:U,n?ln:0):o(e,N[t],n?fn:W,n?un:0),r.setCursor=(e,t,n)=>{K=e.left,q=e.top,da(null,t,n)};function ia(e,t){j(Gi,re,J.left=e),j(Gi,ee,J.width=t)}function aa(e,t){j(Gi,te,J.top=e),j(Gi,D,J.height=t)}let oa=I.ori==0?ia:aa,sa=I.ori==1?ia:aa;function ca(){if(bt&&B.live)for(let e=+(i==2);e<M.length;e++){if(e==0&&Vt)continue;let t=B.values[e],n=0;for(let r in t)zt[e][n++].firstChild.nodeValue=t[r]}}function la(e,t){if(e!=null&&(e.idxs?e.idxs.forEach((e,t)=>{vt[t]=e}):kt(e.idx)||vt.fill(e.idx),B.idx=vt[0]),bt&&B.live){for(let e=0;e<M.length;e++)(e>0||i==1&&!Vt)&&ua(e,vt[e]);ca()}G=!1,t!==!1&&Oa(`setLegend`)}r.setLegend=la;function ua(e,n){let i=M[e],a=e==0&&Je==2?Cr:t[e],o;Vt?o=i.values(r,e,n)??Ut:(o=i.value(r,n==null?null:a[n],e,n),o=o==null?Ut:{_:o}),B.values[e]=o}function da(e,n,a){zi=K,Bi=q,[K,q]=V.move(r,K,q),V.left=K,V.top=q,Ct&&(Ni&&De(Ni,$e(K),0,U,W),Pi&&De(Pi,0,$e(q),U,W));let o,s=hr>gr;Qi=R,$i=null;let c=I.ori==0?U:W,l=I.ori==1?U:W;if(K<0||lr==0||s){o=V.idx=null;for(let e=0;e<M.length;e++){let t=Hn[e];t!=null&&De(t,-10,-10,U,W)}Bn&&X(null,ta,!0,e==null&&$.setSeries),B.live&&(vt.fill(o),G=!0)}else{let e,n,a;i==1&&(e=I.ori==0?K:q,n=ra(e,P),o=V.idx=Fe(n,t[0],hr,gr),a=Ye(t[0][o],I,c,0));let s=-10,u=-10,d=0,f=0,p=!0,m=``,h=``;for(let e=+(i==2);e<M.length;e++){let g=M[e],_=vt[e],v=_==null?null:i==1?t[e][_]:t[e][1][_],y=V.dataIdx(r,e,o,n),b=y==null?null:i==1?t[e][y]:t[e][1][y];if(G=G||b!=v||y!=_,vt[e]=y,e>0&&g.show){let n=y==null?-10:y==o?a:Ye(i==1?t[0][y]:t[e][0][y],I,c,0),_=b==null?-10:Xe(b,i==1?N[g.scale]:N[g.facets[1].scale],l,0);if(Bn&&b!=null){let t=I.ori==1?K:q,n=Qe(zn.dist(r,e,y,_,t));if(n<Qi){let r=zn.bias;if(r!=0){let i=ra(t,g.scale),a=b>=0?1:-1,o=i>=0?1:-1;o==a&&(o==1?r==1?b>=i:b<=i:r==1?b<=i:b>=i)&&(Qi=n,$i=e)}else Qi=n,$i=e}}if(G||Vn){let t,i;I.ori==0?(t=n,i=_):(t=_,i=n);let a,o,c,l,g,v,y=!0,b=Rn.bbox;if(b!=null){y=!1;let t=b(r,e);c=t.left,l=t.top,a=t.width,o=t.height}else c=t,l=i,a=o=Rn.size(r,e);if(v=Rn.fill(r,e),g=Rn.stroke(r,e),Vn)e==$i&&Qi<=zn.prox&&(s=c,u=l,d=a,f=o,p=y,m=v,h=g);else{let t=Hn[e];t!=null&&(Wn[e]=c,Gn[e]=l,je(t,a,o,y),ke(t,v,g),De(t,et(c),et(l),U,W))}}}}if(Vn){let e=zn.prox;if(G||(ea==null?Qi<=e:Qi>e||$i!=ea)){let e=Hn[0];e!=null&&(Wn[0]=s,Gn[0]=u,je(e,d,f,p),ke(e,m,h),De(e,et(s),et(u),U,W))}}}if(J.show&&Vi){if(e!=null){let[t,n]=$.scales,[r,i]=$.match,[a,o]=e.cursor.sync.scales,s=e.cursor.drag;if(Ui=s._x,Wi=s._y,Ui||Wi){let{left:s,top:u,width:d,height:f}=e.select,p=e.scales[a].ori,m=e.posToVal,h,g,_,v,y,b=t!=null&&r(t,a),x=n!=null&&i(n,o);b&&Ui?(p==0?(h=s,g=d):(h=u,g=f),_=N[t],v=Ye(m(h,a),_,c,0),y=Ye(m(h+g,a),_,c,0),oa(tt(v,y),Qe(y-v))):oa(0,c),x&&Wi?(p==1?(h=s,g=d):(h=u,g=f),_=N[n],v=Xe(m(h,o),_,l,0),y=Xe(m(h+g,o),_,l,0),sa(tt(v,y),Qe(y-v))):sa(0,l)}else _a()}else{let e=Qe(zi-Fi),t=Qe(Bi-Ii);if(I.ori==1){let n=e;e=t,t=n}Ui=Hi.x&&e>=Hi.dist,Wi=Hi.y&&t>=Hi.dist;let n=Hi.uni;n==null?Hi.x&&Hi.y&&(Ui||Wi)&&(Ui=Wi=!0):Ui&&Wi&&(Ui=e>=n,Wi=t>=n,!Ui&&!Wi&&(t>e?Wi=!0:Ui=!0));let r,i;Ui&&(I.ori==0?(r=Li,i=K):(r=Ri,i=q),oa(tt(r,i),Qe(i-r)),Wi||sa(0,l)),Wi&&(I.ori==1?(r=Li,i=K):(r=Ri,i=q),sa(tt(r,i),Qe(i-r)),Ui||oa(0,c)),!Ui&&!Wi&&(oa(0,0),sa(0,0))}}if(Hi._x=Ui,Hi._y=Wi,e==null){if(a){if(Aa!=null){let[e,t]=$.scales;$.values[0]=e==null?null:ra(I.ori==0?K:q,e),$.values[1]=t==null?null:ra(I.ori==1?K:q,t)}Ma(se,r,K,q,U,W,o)}if(Bn){let e=a&&$.setSeries,t=zn.prox;ea==null?Qi<=t&&X($i,ta,!0,e):Qi>t?X(null,ta,!0,e):$i!=ea&&X($i,ta,!0,e)}}G&&(B.idx=o,la()),n!==!1&&Oa(`setCursor`)}let fa=null;Object.defineProperty(r,"rect",{get(){return fa??pa(!1),fa}});function pa(e=!1){e?fa=null:(fa=xe.getBoundingClientRect(),Oa(`syncRect`,fa))}function ma(e,t,n,r,i,a,o){V._lock||Vi&&e!=null&&e.movementX==0&&e.movementY==0||(ha(e,t,n,r,i,a,o,!1,e!=null),e==null?da(t,!0,!1):da(null,!0,!0))}function ha(e,t,n,i,a,o,s,c,l){if(fa??pa(!1),Ln(e),e!=null)n=e.clientX-fa.left,i=e.clientY-fa.top;else{if(n<0||i<0){K=-10,q=-10;return}let[e,r]=$.scales,s=t.cursor.sync,[c,l]=s.values,[u,d]=s.scales,[f,p]=$.match,m=t.axes[0].side%2==1,h=I.ori==0?U:W,g=I.ori==1?U:W,_=m?o:a,v=m?a:o,y=m?i:n,b=m?n:i;if(n=u==null?y/_*h:f(e,u)?ae(c,N[e],h,0):-10,i=d==null?b/v*g:p(r,d)?ae(l,N[r],g,0):-10,I.ori==1){let e=n;n=i,i=e}}l&&(t==null||t.cursor.event.type==se)&&((n<=1||n>=U-1)&&(n=yt(n,U)),(i<=1||i>=W-1)&&(i=yt(i,W))),c?(Fi=n,Ii=i,[Li,Ri]=V.move(r,n,i)):(K=n,q=i)}let ga={width:0,height:0,left:0,top:0};function _a(){Ki(ga,!1)}let va,ya,ba,Q;function xa(e,t,n,i,a,o,s){Vi=!0,Ui=Wi=Hi._x=Hi._y=!1,ha(e,t,n,i,a,o,s,!0,!1),e!=null&&(Yt(le,_e,Sa,!1),Ma(ce,r,Li,Ri,U,W,null));let{left:c,top:l,width:u,height:d}=J;va=c,ya=l,ba=u,Q=d}function Sa(e,t,n,i,a,o,s){Vi=Hi._x=Hi._y=!1,ha(e,t,n,i,a,o,s,!1,!0);let{left:c,top:l,width:u,height:d}=J,f=u>0||d>0,p=va!=c||ya!=l||ba!=u||Q!=d;if(f&&p&&Ki(J),Hi.setScale&&f&&p){let e=c,t=u,n=l,r=d;if(I.ori==1&&(e=l,t=d,n=c,r=u),Ui&&Y(P,ra(e,P),ra(e+t,P)),Wi)for(let e in N){let t=N[e];e!=P&&t.from==null&&t.min!=R&&Y(e,ra(n+r,e),ra(n,e))}_a()}else V.lock&&(V._lock=!V._lock,da(t,!0,e!=null));e!=null&&(Xt(le,_e),Ma(le,r,K,q,U,W,null))}function Ca(e,t,n,r,i,a,o){if(V._lock)return;Ln(e);let s=Vi;if(Vi){let e=!0,t=!0,n,r;I.ori==0?(n=Ui,r=Wi):(n=Wi,r=Ui),n&&r&&(e=K<=10||K>=U-10,t=q<=10||q>=W-10),n&&e&&(K=K<Li?0:U),r&&t&&(q=q<Ri?0:W),da(null,!0,!0),Vi=!1}K=-10,q=-10,vt.fill(null),da(null,!0,!0),s&&(Vi=s)}function wa(e,t,n,i,a,o,s){V._lock||(Ln(e),Ar(),_a(),e!=null&&Ma(fe,r,K,q,U,W,null))}function Ta(){Me.forEach(yi),vn(r.width,r.height,!0)}Ne(he,ve,Ta);let Ea={};Ea.mousedown=xa,Ea.mousemove=ma,Ea.mouseup=Sa,Ea.dblclick=wa,Ea.setSeries=(e,t,n,i)=>{let a=$.match[2];n=a(r,t,n),n!=-1&&X(n,i,!0,!1)},Ct&&(Yt(ce,xe,xa),Yt(se,xe,ma),Yt(ue,xe,e=>{Ln(e),pa(!1)}),Yt(de,xe,Ca),Yt(fe,xe,wa),ri.add(r),r.syncRect=pa);let Da=r.hooks=e.hooks||{};function Oa(e,t,n){wi?Ti.push([e,t,n]):e in Da&&Da[e].forEach(e=>{e.call(null,r,t,n)})}(e.plugins||[]).forEach(e=>{for(let t in e.hooks)Da[t]=(Da[t]||[]).concat(e.hooks[t])});let ka=(e,t,n)=>n,$=It({key:null,setSeries:!1,filters:{pub:gt,sub:gt},scales:[P,M[1]?M[1].scale:null],match:[_t,_t,ka],values:[null,null]},V.sync);$.match.length==2&&$.match.push(ka),V.sync=$;let Aa=$.key,ja=wr(Aa);function Ma(e,t,n,r,i,a,o){$.filters.pub(e,t,n,r,i,a,o)&&ja.pub(e,t,n,r,i,a,o)}ja.sub(r);function Na(e,t,n,r,i,a,o){$.filters.sub(e,t,n,r,i,a,o)&&Ea[e](null,t,n,r,i,a,o)}r.pub=Na;function Pa(){ja.unsub(r),ri.delete(r),Jt.clear(),Pe(he,ve,Ta),me.remove(),Nt?.remove(),Oa(`destroy`)}r.destroy=Pa;function Fa(){Oa(`init`,e,t),Or(t||e.data,!1),L[P]?Ai(P,L[P]):Ar(),_n=J.show&&(J.width>0||J.height>0),gn=G=!0,vn(e.width,e.height)}return M.forEach(qn),Me.forEach(ar),n?n instanceof HTMLElement?(n.appendChild(me),Fa()):n(r,Fa):Fa(),r}bi.assign=It,bi.fmtNum=Ye,bi.rangeNum=Ke,bi.rangeLog=Be,bi.rangeAsinh=Ve,bi.orient=Dr,bi.pxRatio=A,bi.join=Vt,bi.fmtDate=$t,bi.tzDate=en,bi.sync=wr;{bi.addGap=Mr,bi.clipGaps=jr;let e=bi.paths={points:Kr};e.linear=Xr,e.stepped=Zr,e.bars=$r,e.spline=ti}var xi=25.4,Si=`mm`,Ci=e=>{Si=e},wi=()=>Si,Ti=()=>Si===`mm`?`µm`:`thou`,Ei=e=>Si===`mm`?e:e/xi;function Di(e){let t=Number(e);return e===`-`||!Number.isFinite(t)?`–`:Si===`in`?(t/xi).toFixed(3):typeof e==`string`?e:e.toFixed(2)}function Oi(e){let t=(Si===`mm`?e:e/xi).toFixed(Si===`mm`?3:4);return Number(t)===0?t.replace(`-`,``):t.replace(`-`,`−`)}var ki=e=>`${Number((Si===`mm`?e:e/xi).toPrecision(3))} ${Si}`,Ai=2400,ji=class{onPick=()=>{};#e;#t=[];#n;constructor(e){this.#n=e,new ResizeObserver(()=>this.#e?.setSize({width:e.clientWidth,height:e.clientHeight})).observe(e)}show(e){if(this.#t=e,this.#e?.destroy(),this.#e=void 0,!e.length)return;let n={stroke:t(`--grid`),width:1},r={stroke:t(`--ink-3`),grid:n,ticks:n,font:`12px system-ui, sans-serif`},i={width:this.#n.clientWidth,height:this.#n.clientHeight,legend:{show:!1},scales:{x:{time:!1}},cursor:{drag:{x:!0,y:!1,setScale:!1},points:{show:!1}},axes:[{...r,size:28,values:(e,t)=>t.map((e,n)=>n===t.length-1?`${e} s`:`${e}`)},{...r,size:52,label:Ti(),labelSize:16,labelFont:`12px system-ui, sans-serif`}],series:[{},...e.map((e,n)=>({label:e.figures.name,stroke:t(`--run-${n}`),width:1,points:{show:!1}}))],hooks:{setSelect:[e=>{let{left:t,width:n}=e.select;n>4&&this.#i(e.posToVal(t,`x`),e.posToVal(t+n,`x`)),e.setSelect({left:0,top:0,width:0,height:0},!1)}]}};this.#e=new bi(i,this.#a(0,this.#r()),this.#n),this.#e.over.addEventListener(`click`,()=>{let e=this.#e.cursor.left??-1;e>=0&&this.onPick(this.#e.posToVal(e,`x`))}),this.#e.over.addEventListener(`dblclick`,()=>this.#i(0,this.#r()))}tool(e){let t=this.#e;t?.setCursor({left:t.valToPos(e,`x`),top:t.over.clientHeight/2},!1)}#r(){return Math.max(...this.#t.map(({t_s:e})=>e[e.length-1]??0))}#i(e,t){this.#e.setData(this.#a(e,t),!1),this.#e.batch(()=>{this.#e.setScale(`x`,{min:e,max:t})})}#a(e,t){let n=(t-e)/Ai||1,r=Array.from({length:2401},(t,r)=>e+r*n);return[r,...this.#t.map(({t_s:t,error_um:i,cutting:a})=>{let o=r.map(()=>null),s=(e,t)=>{Math.abs(t)>Math.abs(o[e]??0)&&(o[e]=t)};for(let r=0;r<t.length;r++){let o=Math.round((t[r]-e)/n);if(!a[r]||o<0||o>Ai)continue;let c=Ei(i[r]);if(s(o,c),!a[r+1])continue;let l=Math.min(Ai,Math.round((t[r+1]-e)/n));for(let e=o+1;e<l;e++)s(e,c+(Ei(i[r+1])-c)*(e-o)/(l-o))}return o})]}},Mi=class{onChange=()=>{};#e;#t;#n=new Map;#r=0;#i=1;constructor(e,t){[this.#e,this.#t]=[e,t],e.addEventListener(`input`,()=>{this.#s(),this.onChange()}),e.addEventListener(`scroll`,()=>this.#c()),new ResizeObserver(()=>this.#c()).observe(e)}get value(){return this.#e.value}set value(e){this.#e.value=e,this.#e.scrollTop=this.#r=0,this.#n.clear(),this.#s()}mark(e){this.#n=new Map([...e].reverse().map(({line:e,severity:t})=>[e,t])),this.#c()}current(e){e!==this.#r&&(this.#r=e,this.#o(e),this.#c())}go({line:e,column:t,length:n}){let r=this.value.split(`
`).slice(0,e-1).reduce((e,t)=>e+t.length+1,0)+Math.max(0,t-1);this.#e.focus(),this.#e.setSelectionRange(r,r+n),this.#o(e)}get#a(){return parseFloat(getComputedStyle(this.#e).lineHeight)}#o(e){let t=this.#a,n=(e-1)*t,{scrollTop:r,clientHeight:i}=this.#e;(n<r||n>r+i-2*t)&&(this.#e.scrollTop=n-i/2)}#s(){let e=this.value;this.#i=1;for(let t=-1;(t=e.indexOf(`
`,t+1))>=0;)this.#i++;this.#c()}#c(){let e=this.#a,{scrollTop:t,clientHeight:n}=this.#e,r=Math.floor(t/e)+1,i=Math.min(this.#i,r+Math.ceil(n/e)),a=[];for(let e=r;e<=i;e++){let t=document.createElement(`div`),n=this.#n.get(e);t.textContent=String(e),n&&t.classList.add(n),e===this.#r&&t.classList.add(`current`),a.push(t)}this.#t.replaceChildren(...a),this.#t.style.setProperty(`--shift`,`${(r-1)*e-t}px`)}},Ni;function Pi(){return Ni??=Fi(`engine.wasm.gz`).then(e=>WebAssembly.compile(e)),Ni}async function Fi(e){let t=await fetch(e);if(!t.ok)throw Error(`${e} is missing: ${t.status}`);let n=await t.arrayBuffer(),r=new Uint8Array(n,0,2);return r[0]!==31||r[1]!==139?n:new Response(new Blob([n]).stream().pipeThrough(new DecompressionStream(`gzip`))).arrayBuffer()}var Ii=class extends Error{},Li=class{#e;#t=new Map;#n=0;async ask(e,t={}){let n=await Pi(),r=this.#e??=this.#r(),i=++this.#n;return new Promise((a,o)=>{this.#t.set(i,{resolve:a,reject:o,listener:t}),r.postMessage({id:i,module:n,request:e})})}cancel(){this.#e?.terminate(),this.#e=void 0;let e=[...this.#t.values()];this.#t.clear(),e.forEach(e=>e.reject(new Ii(`cancelled`)))}#r(){let e=new Worker(new URL(new URL(`engine.js`,import.meta.url).href,``+import.meta.url),{type:`module`,name:`engine`});return e.onmessage=({data:e})=>{let t=this.#t.get(e.id);t&&(e.kind===`progress`?t.listener.progress?.(e.stage,e.part):e.kind===`points`?t.listener.points?.(e.points):(this.#t.delete(e.id),e.kind===`done`?t.resolve(e.answer):t.reject(Error(e.reason))))},e.onerror=e=>{this.#t.forEach(t=>t.reject(Error(e.message||`the engine does not start`))),this.#t.clear()},e}},Ri={star:{about:`Rounded star, 220 arcs`,program:`(Rounded five-pointed star: 12 + 4 cos 5a times cos a, sin a, a from 0 to 360 degrees, mm)
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
`}},zi=class{play;slider;speed;onMove=()=>{};#e;#t=0;#n;constructor(e,t,n){this.play=e,this.slider=t,this.speed=n,e.addEventListener(`click`,()=>this.#n?this.stop():this.#r()),t.addEventListener(`input`,()=>{this.stop(),this.time(Number(t.value))}),n.addEventListener(`change`,()=>this.#n&&this.#r())}show(e){this.stop(),this.#e=e,this.#t=0;let t=e?e.t_s[e.t_s.length-1]:0;[this.slider.max,this.slider.step,this.slider.value]=[String(t),String(t/2e3||1),`0`],this.play.disabled=this.slider.disabled=this.speed.disabled=!e}time(e){let t=this.#e?.t_s;if(!t)return;let[n,r]=[0,t.length-1];for(;n<r;){let i=n+r>>1;t[i]<e?n=i+1:r=i}this.index(n>0&&e-t[n-1]<t[n]-e?n-1:n)}index(e){this.#e&&(this.#t=e,this.slider.value=String(this.#e.t_s[e]),this.onMove(e))}stop(){this.#n=void 0,this.play.textContent=`Play`}#r(){let e=this.#e?.t_s;if(!e)return;let t=this.#t>=e.length-1?0:e[this.#t],n={at:performance.now(),t_s:t};this.#n=n,this.play.textContent=`Pause`;let r=()=>{if(this.#n!==n)return;let i=t+(performance.now()-n.at)/1e3*Number(this.speed.value);this.time(i),i>=e[e.length-1]?this.stop():requestAnimationFrame(r)};requestAnimationFrame(r)}};function Bi(e,t,n){let r=e.length/3,i=new Int16Array(r).fill(-1),a=new Uint32Array(t+1);for(let e=1;e<r;e++)i[e]=n(e),i[e]>=0&&a[i[e]+1]++;for(let e=0;e<t;e++)a[e+1]+=a[e];let o=new Uint32Array(a[t]),s=a.slice();for(let e=1;e<r;e++)i[e]>=0&&(o[s[i[e]]++]=e);return{count:r,points:e,ends:o,starts:a}}var K=.7,q=32;function Vi(e,{ends:t,starts:n},r,{at:i,width:a,height:o,oneOf:s}){let c=-1,l=0,u=0;for(let d=n[r];d<n[r+1];d++){let f=t[d];if(s>1&&Math.floor(f/q)%s)continue;let p=i[2*f],m=i[2*f+1],h=i[2*f-2],g=i[2*f-1];p<0&&h<0||m<0&&g<0||p>a&&h>a||m>o&&g>o||(c!==f-1&&(e.moveTo(h,g),l=h,u=g),c=f,d+1<n[r+1]&&t[d+1]===f+1&&Math.abs(p-l)+Math.abs(m-u)<K||(e.lineTo(p,m),l=p,u=m))}}var Hi={top:[[1,0,0],[0,1,0]],front:[[1,0,0],[0,0,1]],right:[[0,1,0],[0,0,1]],iso:[[Math.SQRT1_2,Math.SQRT1_2,0],[-.408248,.408248,.816497]]},[Ui,Wi]=[50,20],J=256,Gi=200,Ki=class{gain=0;onPick=()=>{};#e;#t;#n=`top`;#r={x:0,y:0,scale:1};#i=!0;#a;#o;#s;#c=1;#l=[];#u;#d=new Float32Array;#f=0;#p=1;#m=-1/0;#h=0;#g;constructor(e){[this.#e,this.#t]=[0,1].map(()=>e.appendChild(document.createElement(`canvas`))),this.#t.tabIndex=0,this.#t.setAttribute(`role`,`img`),new ResizeObserver(()=>this.#T()).observe(e),this.#D()}get shownGain(){return this.#o?this.gain||this.#v():1}get largest_um(){return this.#c}describe(e){this.#t.setAttribute(`aria-label`,e)}program({points:e,kinds:t}){this.#a=Bi(e,2,e=>t[e]&1),this.#g=qi(e),this.#i&&this.fit(),this.redraw()}cut(e,t){this.#o=e,this.#c=t||1,this.#l=[],this.#u=void 0,this.regain()}add(e){this.#l.push(e);let t=e.length-4;t>=0&&(this.#u=[e[t],e[t+1],e[t+2]]),this.redraw()}side(e){this.#n=e,this.fit()}fit(){if(this.#i=!0,!this.#g)return;let e=[0,1,2,3,4,5,6,7].map(e=>this.#S([0,1,2].map(t=>this.#g[e>>t&1][t]))),[t,n]=[e.map(([e])=>e),e.map(([,e])=>e)],[r,i,a,o]=[Math.min(...t),Math.max(...t),Math.min(...n),Math.max(...n)],{clientWidth:s,clientHeight:c}=this.#e,l=e=>Math.max(1,e-56),u=Math.min(l(s)/Math.max(i-r,1e-6),l(c)/Math.max(o-a,1e-6));this.#r={x:(r+i)/2,y:(a+o)/2,scale:Math.min(u,1e5)},this.redraw()}zoomTo(e){if(!this.#g)return;let[t,n]=this.#g,r=Math.hypot(n[0]-t[0],n[1]-t[1],n[2]-t[2]),[i,a]=this.#S(e);this.#i=!1,this.#r={x:i,y:a,scale:Math.min(this.#e.clientWidth,this.#e.clientHeight)/Math.max(.1*r,.001)},this.redraw()}tool(e){let t=this.#o,n=this.#s?.points;this.#u=t&&n&&e!==void 0?[0,1,2].map(t=>n[3*e+t]):void 0,this.#b()}redraw(){this.#f||=requestAnimationFrame(()=>{this.#f=0,this.draw()})}#_(){this.#i=!1,clearTimeout(this.#h),this.#h=setTimeout(()=>{this.#m=-1/0,this.redraw()},Gi),this.#f||=requestAnimationFrame(e=>{this.#f=0;let t=e-this.#m;this.#m=e,t<1e3&&t>Ui?this.#p=Math.min(J,2*this.#p):t<Wi&&(this.#p=Math.max(1,this.#p/2)),this.draw(this.#p)})}draw(e=1){let n=this.#e.getContext(`2d`),r=devicePixelRatio,{clientWidth:i,clientHeight:o}=this.#e;n.setTransform(r,0,0,r,0,0),n.clearRect(0,0,i,o),n.lineJoin=`round`,this.#x(n,i,o);let s=(t,r,a)=>{n.beginPath(),Vi(n,t,r,{at:a,width:i,height:o,oneOf:e}),n.stroke()};if(this.#a){let e=this.#w(this.#a.points);[n.lineWidth,n.strokeStyle]=[1,t(`--rapid`)],n.setLineDash([3,4]),s(this.#a,0,e),n.setLineDash([]),[n.lineWidth,n.strokeStyle]=[1,t(`--path`)],s(this.#a,1,e)}if(this.#s){let e=this.#w(this.#s.points);n.lineWidth=this.#s.ends.length>3e4?1:1.8;for(let t=0;t<24;t++)n.strokeStyle=a((t+.5)/24),s(this.#s,t,e)}this.#y(n),this.#b()}regain(){let e=this.#o;if(e){let t=this.shownGain,n=e.foot_mm.map((n,r)=>n+t*e.deviation_mm[r]),r=t=>e.cutting[t]?Math.min(23,Math.floor(24*Math.abs(e.error_um[t])/this.#c)):-1;this.#s=Bi(n,24,r)}else this.#s=void 0;this.redraw()}#v(){if(!this.#g)return 1;let[e,t]=this.#g,n=.02*Math.hypot(t[0]-e[0],t[1]-e[1])/(.001*this.#c),r=10**Math.floor(Math.log10(n));return Math.max(1,r*([5,2,1].find(e=>e*r<=n)??1))}#y(e){if(!this.#l.length)return;e.lineWidth=1.8,e.strokeStyle=t(`--run-1`),e.beginPath();let n=!1;for(let t of this.#l)for(let r=0;r<t.length;r+=4){let[i,a]=this.#C([t[r],t[r+1],t[r+2]]);Number.isNaN(t[r+3])?n=!1:n?e.lineTo(i,a):(e.moveTo(i,a),n=!0)}e.stroke()}#b(){let e=this.#t.getContext(`2d`),n=devicePixelRatio;if(e.setTransform(n,0,0,n,0,0),e.clearRect(0,0,this.#t.clientWidth,this.#t.clientHeight),!this.#u)return;let[r,i]=this.#C(this.#u);e.fillStyle=t(`--panel`),e.strokeStyle=t(`--ink`),e.lineWidth=2,e.beginPath(),e.arc(r,i,5,0,2*Math.PI),e.fill(),e.stroke()}#x(e,n,r){let{x:i,y:a,scale:o}=this.#r,s=64/o,c=10**Math.floor(Math.log10(s)),l=c*([2,5,10].find(e=>e*c>=s)??10);e.strokeStyle=t(`--grid`),e.lineWidth=1,e.beginPath();for(let t=Math.ceil((i-n/2/o)/l);t*l<i+n/2/o;t++){let a=Math.round(n/2+(t*l-i)*o)+.5;e.moveTo(a,0),e.lineTo(a,r)}for(let t=Math.ceil((a-r/2/o)/l);t*l<a+r/2/o;t++){let i=Math.round(r/2-(t*l-a)*o)+.5;e.moveTo(0,i),e.lineTo(n,i)}e.stroke(),this.onGrid(l,this.#n)}onGrid=()=>{};#S([e,t,n]){let[r,i]=Hi[this.#n];return[r[0]*e+r[1]*t+r[2]*n,i[0]*e+i[1]*t+i[2]*n]}#C(e){let[t,n]=this.#S(e),{x:r,y:i,scale:a}=this.#r;return[this.#e.clientWidth/2+(t-r)*a,this.#e.clientHeight/2-(n-i)*a]}#w(e){let t=e.length/3,[n,r]=Hi[this.#n],{x:i,y:a,scale:o}=this.#r;this.#d.length<2*t&&(this.#d=new Float32Array(2*t));let s=this.#d,[c,l]=[this.#e.clientWidth/2-i*o,this.#e.clientHeight/2+a*o];for(let i=0;i<t;i++){let t=e[3*i],a=e[3*i+1],u=e[3*i+2];s[2*i]=c+o*(n[0]*t+n[1]*a+n[2]*u),s[2*i+1]=l-o*(r[0]*t+r[1]*a+r[2]*u)}return s}#T(){for(let e of[this.#e,this.#t])e.width=Math.round(e.clientWidth*devicePixelRatio),e.height=Math.round(e.clientHeight*devicePixelRatio);this.#i&&this.fit(),this.draw()}pan(e,t){this.#r.x-=e/this.#r.scale,this.#r.y+=t/this.#r.scale,this.#_()}zoom(e,t=this.#e.clientWidth/2,n=this.#e.clientHeight/2){let r=this.#r,[i,a]=[t-this.#e.clientWidth/2,this.#e.clientHeight/2-n],o=Math.min(1e6,Math.max(1e-4,r.scale*e));r.x+=i/r.scale-i/o,r.y+=a/r.scale-a/o,r.scale=o,this.#_()}#E(e,t){if(!this.#s)return;let n=this.#w(this.#s.points),[r,i]=[void 0,576];for(let a=0;a<this.#s.count;a++){let o=(n[2*a]-e)**2+(n[2*a+1]-t)**2;o<i&&([r,i]=[a,o])}return r}#D(){let e=this.#t,t=new Map,n=0;e.addEventListener(`wheel`,e=>{e.preventDefault(),this.zoom(Math.exp(-.0015*e.deltaY*(e.deltaMode===1?16:1)),e.offsetX,e.offsetY)},{passive:!1}),e.addEventListener(`pointerdown`,r=>{e.setPointerCapture(r.pointerId),t.set(r.pointerId,{x:r.offsetX,y:r.offsetY}),t.size===1&&(n=0)}),e.addEventListener(`pointermove`,e=>{let r=t.get(e.pointerId);if(!r)return;let i={x:e.offsetX,y:e.offsetY},a=[...t].find(([t])=>t!==e.pointerId)?.[1];if(a){let e=e=>Math.hypot(e.x-a.x,e.y-a.y);this.zoom(e(i)/Math.max(1,e(r)),(i.x+a.x)/2,(i.y+a.y)/2)}let o=a?.5:1;this.pan(o*(i.x-r.x),o*(i.y-r.y)),n+=Math.abs(i.x-r.x)+Math.abs(i.y-r.y),t.set(e.pointerId,i)});let r=e=>{if(t.delete(e.pointerId)&&e.type===`pointerup`&&n<4){let t=this.#E(e.offsetX,e.offsetY);t!==void 0&&this.onPick(t)}};e.addEventListener(`pointerup`,r),e.addEventListener(`pointercancel`,r),e.addEventListener(`dblclick`,()=>this.fit());let i={ArrowLeft:()=>this.pan(40,0),ArrowRight:()=>this.pan(-40,0),ArrowUp:()=>this.pan(0,40),ArrowDown:()=>this.pan(0,-40),"+":()=>this.zoom(1.25),"=":()=>this.zoom(1.25),"-":()=>this.zoom(.8),0:()=>this.fit()};e.addEventListener(`keydown`,e=>{let t=!e.ctrlKey&&!e.metaKey&&i[e.key];t&&(e.preventDefault(),t())})}};function qi(e){if(!e.length)return;let[t,n]=[[1/0,1/0,1/0],[-1/0,-1/0,-1/0]];for(let r=0;r<e.length;r++)t[r%3]=Math.min(t[r%3],e[r]),n[r%3]=Math.max(n[r%3],e[r]);return[t,n]}var Y=e=>document.getElementById(e),X=new Ki(Y(`view`)),Ji=new ji(Y(`curve`)),Yi=new Mi(Y(`text`),Y(`gutter`)),Xi=new zi(Y(`play`),Y(`time`),Y(`speed`)),[Zi,Qi,$i]=[new Li,new Li,new Li],ea=Y(`machine`),ta=Y(`controller`),na=Y(`example`),ra=Y(`control`),Z={name:`program.ngc`,lists:void 0,machineFile:void 0,checked:void 0,answer:void 0,corrected:void 0,shown:0},ia=`file`;function aa(){let e=ea.value===ia&&Z.machineFile;return{name:Z.name,program:Yi.value,machine:e?`${Z.machineFile.text}\n`:ea.value,machine_name:e?Z.machineFile.name:void 0}}var oa=()=>new Date().toISOString().slice(0,10);function sa(e,t,n=``){return Z.name=e,Yi.value=t,na.value=n,Y(`name`).textContent=e,document.title=`${e} · feedwright`,Y(`welcome`).hidden=!0,X.fit(),da(),Na(),pa()}async function ca(e){await sa(`${e}.ngc`,Ri[e].program,e),await ha()}async function la(e){for(let t of e){let e=await t.text();/\.toml$/i.test(t.name)?ua(t.name,e):await sa(t.name,e)}}function ua(e,t){Z.machineFile={name:e,text:t},ea.querySelector(`[value=${ia}]`)?.remove(),ea.prepend(new Option(e,ia)),ea.value=ia,da(),pa()}function da(){Qi.cancel(),[Z.answer,Z.corrected,Z.shown]=[void 0,void 0,0],ba(``),wa(),ka()}var fa=0;async function pa(){let e=++fa;if(Zi.cancel(),!Z.lists||!Yi.value.trim())Z.checked=void 0,xa();else try{let t=await Zi.ask({...aa(),task:`check`});if(e!==fa)return;Z.checked=t,xa()}catch(t){!(t instanceof Ii)&&e===fa&&ba(String(t.message))}}async function ma(e){Qi.cancel(),ba(``);let t=performance.now(),n=``,r=(e,r)=>{e!==n&&([n,t]=[e,performance.now()]);let i=(performance.now()-t)/1e3*(1/r-1);Y(`stage`).textContent=e,Y(`bar`).value=r,Y(`left`).textContent=r>.05&&r<1&&i>=1?`${Math.ceil(i)} s left in this step`:``};va(!0),r(`starting`,0);try{await e(r)}catch(e){if(e instanceof Ii)return;ba(String(e.message))}va(!1)}async function ha(){Y(`run`).disabled||(await ma(async e=>{X.cut(void 0,1);let t={...aa(),task:`run`,controller:ta.value,recorded_on:oa(),page:!0};Z.answer=await Qi.ask(t,{progress:e,points:e=>X.add(e)}),wa()}),Z.answer||X.cut(void 0,1))}async function ga(){await ma(async e=>{Z.corrected=await Qi.ask({...aa(),task:`correct`,target:ra.value},{progress:e}),ka()})}function _a(){Qi.cancel(),va(!1),Z.answer||X.cut(void 0,1)}function va(e){Y(`work`).hidden=!e,document.body.classList.toggle(`busy`,e),ya()}function ya(){let e=!!Z.lists&&!!Z.checked?.amounts&&Y(`work`).hidden;for(let t of[`run`,`correct`])Y(t).disabled=!e}function ba(e){Y(`message`).textContent=e,Y(`message`).hidden=!e}function Q(e,t=``,n=``){let r=document.createElement(e);return[r.textContent,r.className]=[t,n],r}function xa(){let{checked:e}=Z,t=e?.findings??[];e&&X.program(e),Yi.mark(t),Y(`findings`).replaceChildren(...t.slice(0,200).map(Sa));let n=e?.amounts,r=t.filter(({severity:e})=>e===`error`).length;Y(`amounts`).textContent=n?`${n.lines} lines, ${n.motions} motions, ${ki(n.feed_mm)} of cuts, ${ki(n.rapid_mm)} of rapids. Read as ${n.dialect}.`:r?`${r} mistake${r===1?``:`s`}: nothing can be cut.`:``,ya()}function Sa(e){let t=Q(`li`,``,e.severity),n=Q(`button`);return n.type=`button`,n.append(Q(`b`,`${e.line}:${e.column} ${e.severity}`),` ${e.message}`),e.hint&&n.append(Q(`small`,`hint: ${e.hint}`)),n.addEventListener(`click`,()=>Yi.go(e)),t.append(n),t}var Ca=e=>Math.max(...e.map(({figures:e})=>Number(e.max_um)).filter(Number.isFinite),0);function wa(){let{answer:e}=Z,t=e?.cuts??[];for(let t of[`figures`,`report`,`worst-title`,`legend`])Y(t).hidden=!e;Y(`verdict`).textContent=e?.verdict.split(` Cost:`)[0]??`Run shows what the machine will cut without a correction and with the controller.`,Ta(Y(`figures`),t.map(({figures:e})=>e),!0),Y(`shown`).replaceChildren(...t.map(({figures:e},t)=>{let n=Q(`button`,e.name);return n.type=`button`,n.addEventListener(`click`,()=>Ea(t)),n})),Ji.show(t),Y(`key`).replaceChildren(Q(`b`,`Contour error over time`),...t.map(({figures:e},t)=>Q(`span`,e.name,`run run-${t}`))),Ea(Math.min(Z.shown,Math.max(0,t.length-1)))}function Ta(e,t,n=!1){e.querySelectorAll(`.unit`).forEach(e=>e.textContent=Ti()),e.querySelector(`tbody`).replaceChildren(...t.map((e,t)=>{let r=Q(`tr`),i=Q(`th`,e.name,n?`run run-${t}`:``);return i.scope=`row`,r.append(i,...[e.time_s,Di(e.rms_um),Di(e.max_um)].map(e=>Q(`td`,e))),r}))}function Ea(e){Z.shown=e;let t=Z.answer?.cuts??[],n=t[e];[...Y(`shown`).children].forEach((t,n)=>t.setAttribute(`aria-pressed`,String(n===e))),X.cut(n,Ca(t)),Xi.show(n),Y(`readout`).textContent=``,Y(`largest`).textContent=`${Di(Ca(t))} ${Ti()}`,Y(`worst`).replaceChildren(...(n?.worst??[]).map(e=>Da(e))),Oa(),X.describe(n?`Path of ${Z.name}, ${n.figures.name}: largest contour error ${Di(n.figures.max_um)} ${Ti()}. Arrow keys move, + and − zoom, 0 fits.`:`Path of ${Z.name}`)}function Da(e){let t=Q(`li`),n=Q(`button`);return n.type=`button`,n.append(Q(`b`,`${Di(Math.abs(e.error_um))} ${Ti()}`),Q(`span`,`line ${e.line}`),Q(`code`,e.text)),n.addEventListener(`click`,()=>{X.zoomTo(e.position_mm),Xi.time(e.t_s),t.parentElement.querySelectorAll(`[aria-current]`).forEach(e=>e.removeAttribute(`aria-current`)),n.setAttribute(`aria-current`,`true`)}),t.append(n),t}function Oa(){let e=X.shownGain;Y(`gain-now`).textContent=e>1?`errors drawn ${e} times too large`:``}function ka(){let{corrected:e}=Z;if(Y(`corrected`).hidden=!e,!e)return;Ta(Y(`corrected`),e.figures);let{refusal:t,hint:n,stretches:r,stretches_changed:i,rounds:a}=e;Y(`correction`).textContent=t?`No corrected program: ${t}.${n?` Hint: ${n}.`:``}`:`${i} of ${r} stretches between corners were changed, found in ${a} simulated cuts. Both cut without feedback, as the control plans them.`;for(let n of[`download`,`take`])Y(n).hidden=!e.program||!!t}function $(e){let t=Z.answer?.cuts[Z.shown];if(!t)return;X.tool(e),Ji.tool(t.t_s[e]),Yi.current(t.line[e]);let n=[0,1,2].map(n=>Oi(t.foot_mm[3*e+n]+t.deviation_mm[3*e+n])),r=t.cutting[e]?`error ${Di(Math.abs(t.error_um[e]))} ${Ti()}`:`rapid or rest`;Y(`readout`).textContent=`${t.t_s[e].toFixed(3)} s   line ${t.line[e]}   X ${n[0]}  Y ${n[1]}  Z ${n[2]} ${wi()}   ${r}`}function Aa(){let e=Y(`colors`),t=e.getContext(`2d`);for(let n=0;n<e.width;n++)t.fillStyle=a(n/e.width),t.fillRect(n,0,1,e.height)}function ja(e,t){let n=Q(`a`);n.href=URL.createObjectURL(t),n.download=e,n.click(),setTimeout(()=>URL.revokeObjectURL(n.href),6e4)}var Ma=()=>Z.name.replace(/\.[^.]*$/,``);function Na(){let{lists:e}=Z;if(!e)return;let t=new URLSearchParams;na.value&&t.set(`example`,na.value),ea.value!==ia&&ea.value!==e.machine&&t.set(`machine`,ea.value),ta.value!==e.controller&&t.set(`controller`,ta.value),ra.value!==e.control&&t.set(`control`,ra.value),wi()!==`mm`&&t.set(`units`,wi()),history.replaceState(null,``,t.size?`#${t}`:location.pathname)}function Pa(){let e=new URLSearchParams(location.hash.slice(1)),t=(t,n)=>{let r=e.get(n);r&&[...t.options].some(e=>e.value===r)&&(t.value=r)};t(ea,`machine`),t(ta,`controller`),t(ra,`control`),e.get(`units`)===`in`&&Fa(`in`);let n=e.get(`example`)??``;return Object.hasOwn(Ri,n)?n:``}function Fa(e){Ci(e),Ia(`[data-units]`,t=>t.dataset.units===e)}function Ia(e,t){document.querySelectorAll(e).forEach(e=>e.setAttribute(`aria-pressed`,String(t(e))))}function La(){Y(`open`).addEventListener(`click`,()=>Y(`file`).click()),Y(`file`).addEventListener(`change`,e=>{let t=e.target;la([...t.files??[]]).then(()=>t.value=``)}),na.addEventListener(`change`,()=>na.value&&ca(na.value));let e=0;Yi.onChange=()=>{na.value=``,Y(`welcome`).hidden=!0,clearTimeout(e),e=setTimeout(()=>{da(),Na(),pa()},200)};for(let e of[ea,ta])e.addEventListener(`change`,()=>{da(),Na(),pa()});ra.addEventListener(`change`,()=>{Z.corrected=void 0,ka(),Na()}),Y(`run`).addEventListener(`click`,ha),Y(`correct`).addEventListener(`click`,ga),Y(`cancel`).addEventListener(`click`,_a),document.addEventListener(`keydown`,e=>{e.key===`Enter`&&(e.ctrlKey||e.metaKey)?ha():e.key===`Escape`&&!Y(`work`).hidden&&_a()}),Ra(),za(),Ba()}function Ra(){Y(`report`).addEventListener(`click`,()=>Z.answer&&ja(`${Ma()}.report.html`,Z.answer.report));let e=()=>new Blob([Z.corrected.program],{type:`text/plain`});Y(`download`).addEventListener(`click`,()=>Z.corrected&&ja(`${Ma()}.corrected.ngc`,e())),Y(`take`).addEventListener(`click`,()=>Z.corrected&&sa(`${Ma()}.corrected.ngc`,Z.corrected.program))}function za(){document.querySelectorAll(`[data-units]`).forEach(e=>e.addEventListener(`click`,()=>{Fa(e.dataset.units),Na(),xa(),wa(),ka()})),document.querySelectorAll(`[data-side]`).forEach(e=>e.addEventListener(`click`,()=>{X.side(e.dataset.side),Ia(`[data-side]`,t=>t===e)})),Y(`fit`).addEventListener(`click`,()=>X.fit()),Y(`gain`).addEventListener(`change`,e=>{X.gain=Number(e.target.value),X.regain(),Oa()}),X.onGrid=(e,t)=>{let n={top:`X right, Y up`,front:`X right, Z up`,right:`Y right, Z up`,iso:`from the front left, above`}[t];Y(`scale`).textContent=Z.checked?`grid ${ki(e)} · ${n}`:``},X.onPick=e=>{Xi.stop(),Xi.index(e)},Ji.onPick=e=>{Xi.stop(),Xi.time(e)},Xi.onMove=$,matchMedia(`(prefers-color-scheme: dark)`).addEventListener(`change`,()=>{Aa(),X.redraw(),Ji.show(Z.answer?.cuts??[])})}function Ba(){let e=0,t=t=>{e=Math.max(0,t),Y(`drop`).hidden=e===0};addEventListener(`dragenter`,n=>{n.preventDefault(),t(e+1)}),addEventListener(`dragleave`,()=>t(e-1)),addEventListener(`dragover`,e=>e.preventDefault()),addEventListener(`drop`,e=>{e.preventDefault(),t(0),la([...e.dataTransfer?.files??[]])})}function Va(e,t,n){e.append(...t.map(({name:e,about:t})=>{let r=new Option(e,e,e===n,e===n);return r.title=t,r}))}async function Ha(){let e=Object.entries(Ri).map(([e,{about:t}])=>{let n=Q(`button`),r=Q(`canvas`);return n.type=`button`,n.dataset.example=e,r.setAttribute(`aria-hidden`,`true`),n.append(r,Q(`b`,e),Q(`span`,t)),n.addEventListener(`click`,()=>ca(e)),{card:n,canvas:r,name:e}});Y(`cards`).replaceChildren(...e.map(({card:e})=>e));for(let{canvas:t,name:n}of e){let{points:e,kinds:r}=await $i.ask({task:`check`,name:n,program:Ri[n].program});Ua(t,e,r)}}function Ua(e,t,n){let r=e.getContext(`2d`),i=devicePixelRatio,{clientWidth:o,clientHeight:s}=e;[e.width,e.height]=[o*i,s*i];let c=e=>t.filter((t,n)=>n%3===e),[l,u]=[c(0),c(1)],[d,f,p,m]=[Math.min(...l),Math.max(...l),Math.min(...u),Math.max(...u)],h=Math.min((o-8)/(f-d||1),(s-8)/(m-p||1));r.setTransform(i,0,0,i,o*i/2,s*i/2),r.strokeStyle=a(.1),r.lineWidth=1.5,r.beginPath(),l.forEach((e,t)=>{let i=[(e-(d+f)/2)*h,-(u[t]-(p+m)/2)*h];n[t]&1?r.lineTo(...i):r.moveTo(...i)}),r.stroke()}async function Wa(){let e=(await(await fetch(`files.json`)).json()).map(async(e,t)=>new File([await(await fetch(`files/${t}`)).blob()],e));await la(await Promise.all(e))}async function Ga(){La(),Aa();for(let[e,{about:t}]of Object.entries(Ri))na.append(Object.assign(new Option(e,e),{title:t}));try{await Pi();let e=Z.lists=await $i.ask({task:`lists`});Va(ea,e.machines,e.machine),Va(ta,e.controllers,e.controller),Va(ra,e.controls,e.control),Y(`version`).textContent=`feedwright ${e.version}.`;let t=Pa();await Wa(),t&&!Yi.value?await ca(t):Yi.value?await pa():await Ha()}catch(e){ba(`The engine does not start: ${e.message}`)}$i.cancel()}Object.assign(globalThis,{feedwright:{view:X}}),Ga();