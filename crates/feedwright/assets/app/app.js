var e=document.createElement(`span`);e.hidden=!0,document.body.append(e);function t(t){return e.style.color=`var(${t})`,getComputedStyle(e).color}var n=()=>matchMedia(`(prefers-color-scheme: dark)`).matches,r=[[104,148,205],[127,143,208],[138,104,186],[141,63,159],[124,18,119],[62,0,66]],i=[[74,110,184],[44,128,160],[38,158,140],[74,190,110],[160,218,57],[253,231,37]];function a(e){let t=n()?i:r,a=Math.min(1,Math.max(0,e))*(t.length-1),o=Math.min(t.length-2,Math.floor(a)),s=a-o;return`rgb(${t[o].map((e,n)=>Math.round(e+s*(t[o+1][n]-e))).join(`,`)})`}var o=!0,s=`uplot`,c=`u-hz`,l=`u-vt`,u=`u-title`,d=`u-wrap`,f=`u-under`,p=`u-over`,m=`u-axis`,h=`u-off`,g=`u-select`,_=`u-cursor-x`,v=`u-cursor-y`,y=`u-cursor-pt`,b=`u-legend`,x=`u-live`,S=`u-inline`,C=`u-series`,w=`u-marker`,T=`u-label`,E=`u-value`,ee=`width`,te=`height`,ne=`top`,re=`bottom`,ie=`left`,ae=`right`,oe=`#000`,se=`#0000`,ce=`mousemove`,le=`mousedown`,ue=`mouseup`,de=`mouseenter`,fe=`mouseleave`,pe=`dblclick`,me=`resize`,he=`scroll`,D=`change`,ge=`dppxchange`,_e=`--`,O=typeof window<`u`,ve=O?document:null,ye=O?window:null,be=O?navigator:null,k,xe;function Se(){let e=devicePixelRatio;k!=e&&(k=e,xe&&Fe(D,xe,Se),xe=matchMedia(`(min-resolution: ${k-.001}dppx) and (max-resolution: ${k+.001}dppx)`),Pe(D,xe,Se),ye.dispatchEvent(new CustomEvent(ge)))}function Ce(e,t){if(t!=null){let n=e.classList;!n.contains(t)&&n.add(t)}}function we(e,t){let n=e.classList;n.contains(t)&&n.remove(t)}function A(e,t,n){e.style[t]=n+`px`}function Te(e,t,n,r){let i=ve.createElement(e);return t!=null&&Ce(i,t),n?.insertBefore(i,r),i}function Ee(e,t){return Te(`div`,e,t)}var De=new WeakMap;function Oe(e,t,n,r,i){let a=`translate(`+t+`px,`+n+`px)`;a!=De.get(e)&&(e.style.transform=a,De.set(e,a),t<0||n<0||t>r||n>i?Ce(e,h):we(e,h))}var ke=new WeakMap;function Ae(e,t,n){let r=t+n;r!=ke.get(e)&&(ke.set(e,r),e.style.background=t,e.style.borderColor=n)}var je=new WeakMap;function Me(e,t,n,r){let i=t+``+n;i!=je.get(e)&&(je.set(e,i),e.style.height=n+`px`,e.style.width=t+`px`,e.style.marginLeft=r?-t/2+`px`:0,e.style.marginTop=r?-n/2+`px`:0)}var j={passive:!0},Ne={...j,capture:!0};function Pe(e,t,n,r){t.addEventListener(e,n,r?Ne:j)}function Fe(e,t,n,r){t.removeEventListener(e,n,j)}O&&Se();function Ie(e,t,n,r){let i;n||=0,r||=t.length-1;let a=r<=2147483647;for(;r-n>1;)i=a?n+r>>1:I((n+r)/2),t[i]<e?n=i:r=i;return e-t[n]<=t[r]-e?n:r}function M(e){return(t,n,r)=>{let i=-1,a=-1;for(let a=n;a<=r;a++)if(e(t[a])){i=a;break}for(let i=r;i>=n;i--)if(e(t[i])){a=i;break}return[i,a]}}var Le=e=>e!=null,N=e=>e!=null&&e>0,Re=M(Le),ze=M(N);function Be(e,t,n,r=0,i=!1){let a=i?ze:Re,o=i?N:Le;[t,n]=a(e,t,n);let s=e[t],c=e[t];if(t>-1){if(r==1)s=e[t],c=e[n];else if(r==-1)s=e[n],c=e[t];else for(let r=t;r<=n;r++){let t=e[r];o(t)&&(t<s?s=t:t>c&&(c=t))}}return[s??L,c??-L]}function Ve(e,t,n,r){let i=at(e),a=at(t);e==t&&(i==-1?(e*=n,t/=n):(e/=n,t*=n));let o=n==10?ot:st,s=i==1?I:tt,c=a==1?tt:I,l=s(o($e(e))),u=c(o($e(t))),d=it(n,l),f=it(n,u);return n==10&&(l<0&&(d=V(d,-l)),u<0&&(f=V(f,-u))),r||n==2?(e=d*i,t=f*a):(e=xt(e,d),t=B(t,f)),[e,t]}function He(e,t,n,r){let i=Ve(e,t,n,r);return e==0&&(i[0]=0),t==0&&(i[1]=0),i}var Ue=.1,We={mode:3,pad:Ue},Ge={pad:0,soft:null,mode:0},Ke={min:Ge,max:Ge};function qe(e,t,n,r){return Mt(n)?F(e,t,n):(Ge.pad=n,Ge.soft=r?0:null,Ge.mode=r?3:0,F(e,t,Ke))}function P(e,t){return e??t}function Je(e,t,n){for(t=P(t,0),n=P(n,e.length-1);t<=n;){if(e[t]!=null)return!0;t++}return!1}function F(e,t,n){let r=n.min,i=n.max,a=P(r.pad,0),o=P(i.pad,0),s=P(r.hard,-L),c=P(i.hard,L),l=P(r.soft,L),u=P(i.soft,-L),d=P(r.mode,0),f=P(i.mode,0),p=t-e,m=ot(p),h=rt($e(e),$e(t)),g=$e(ot(h)-m);(p<1e-24||g>10)&&(p=0,(e==0||t==0)&&(p=1e-24,d==2&&l!=L&&(a=0),f==2&&u!=-L&&(o=0)));let _=p||h||1e3,v=it(10,I(ot(_))),y=V(xt(e-_*(p==0?e==0?.1:1:a),v/10),24),b=e>=l&&(d==1||d==3&&y<=l||d==2&&y>=l)?l:L,x=rt(s,y<b&&e>=b?b:nt(b,y)),S=V(B(t+_*(p==0?t==0?.1:1:o),v/10),24),C=t<=u&&(f==1||f==3&&S>=u||f==2&&S<=u)?u:-L,w=nt(c,S>C&&t<=C?C:rt(C,S));return x==w&&x==0&&(w=100),[x,w]}var Ye=new Intl.NumberFormat(O?be.language:`en-US`),Xe=e=>Ye.format(e),Ze=Math,Qe=Ze.PI,$e=Ze.abs,I=Ze.floor,et=Ze.round,tt=Ze.ceil,nt=Ze.min,rt=Ze.max,it=Ze.pow,at=Ze.sign,ot=Ze.log10,st=Ze.log2,ct=(e,t=1)=>Ze.sinh(e)*t,lt=(e,t=1)=>Ze.asinh(e/t),L=1/0;function ut(e){return(ot((e^e>>31)-(e>>31))|0)+1}function dt(e,t,n){return nt(rt(e,t),n)}function ft(e){return typeof e==`function`}function R(e){return ft(e)?e:()=>e}var pt=()=>{},mt=e=>e,ht=(e,t)=>t,gt=e=>null,_t=e=>!0,vt=(e,t)=>e==t,yt=/\.\d*?(?=9{6,}|0{6,})/gm,z=e=>{if(kt(e)||St.has(e))return e;let t=`${e}`,n=t.match(yt);if(n==null)return e;let r=n[0].length-1;if(t.indexOf(`e-`)!=-1){let[e,n]=t.split(`e`);return+`${z(e)}e${n}`}return V(e,r)};function bt(e,t){return z(V(z(e/t))*t)}function B(e,t){return z(tt(z(e/t))*t)}function xt(e,t){return z(I(z(e/t))*t)}function V(e,t=0){if(kt(e))return e;let n=10**t;return et(e*n*(1+2**-52))/n}var St=new Map;function Ct(e){return((``+e).split(`.`)[1]||``).length}function wt(e,t,n,r){let i=[],a=r.map(Ct);for(let o=t;o<n;o++){let t=$e(o),n=V(it(e,o),t);for(let s=0;s<r.length;s++){let c=e==10?+`${r[s]}e${o}`:r[s]*n,l=(o>=0?0:t)+(o>=a[s]?0:a[s]),u=e==10?c:V(c,l);i.push(u),St.set(u,l)}}return i}var Tt={},Et=[],Dt=[null,null],Ot=Array.isArray,kt=Number.isInteger,At=e=>e===void 0;function jt(e){return typeof e==`string`}function Mt(e){let t=!1;if(e!=null){let n=e.constructor;t=n==null||n==Object}return t}function Nt(e){return typeof e==`object`&&!!e}var Pt=Object.getPrototypeOf(Uint8Array),Ft=`__proto__`;function It(e,t=Mt){let n;if(Ot(e)){let r=e.find(e=>e!=null);if(Ot(r)||t(r)){n=Array(e.length);for(let r=0;r<e.length;r++)n[r]=It(e[r],t)}else n=e.slice()}else if(e instanceof Pt)n=e.slice();else if(t(e)){n={};for(let r in e)r!=Ft&&(n[r]=It(e[r],t))}else n=e;return n}function Lt(e){let t=arguments;for(let n=1;n<t.length;n++){let r=t[n];for(let t in r)t!=Ft&&(Mt(e[t])?Lt(e[t],It(r[t])):e[t]=It(r[t]))}return e}var Rt=0,zt=1,Bt=2;function Vt(e,t,n){for(let r=0,i,a=-1;r<t.length;r++){let o=t[r];if(o>a){for(i=o-1;i>=0&&e[i]==null;)e[i--]=null;for(i=o+1;i<n&&e[i]==null;)e[a=i++]=null}}}function Ht(e,t){if(Gt(e)){let t=e[0].slice();for(let n=1;n<e.length;n++)t.push(...e[n].slice(1));return Kt(t[0])||(t=Wt(t)),t}let n=new Set;for(let t=0;t<e.length;t++){let r=e[t][0],i=r.length;for(let e=0;e<i;e++)n.add(r[e])}let r=[Array.from(n).sort((e,t)=>e-t)],i=r[0].length,a=new Map;for(let e=0;e<i;e++)a.set(r[0][e],e);for(let n=0;n<e.length;n++){let o=e[n],s=o[0];for(let e=1;e<o.length;e++){let c=o[e],l=Array(i).fill(void 0),u=t?t[n][e]:zt,d=[];for(let e=0;e<c.length;e++){let t=c[e],n=a.get(s[e]);t===null?u!=Rt&&(l[n]=t,u==Bt&&d.push(n)):l[n]=t}Vt(l,d,i),r.push(l)}}return r}var Ut=typeof queueMicrotask>`u`?e=>Promise.resolve().then(e):queueMicrotask;function Wt(e){let t=e[0],n=t.length,r=Array(n);for(let e=0;e<r.length;e++)r[e]=e;r.sort((e,n)=>t[e]-t[n]);let i=[];for(let t=0;t<e.length;t++){let a=e[t],o=Array(n);for(let e=0;e<n;e++)o[e]=a[r[e]];i.push(o)}return i}function Gt(e){let t=e[0][0],n=t.length;for(let r=1;r<e.length;r++){let i=e[r][0];if(i.length!=n)return!1;if(i!=t){for(let e=0;e<n;e++)if(i[e]!=t[e])return!1}}return!0}function Kt(e,t=100){let n=e.length;if(n<=1)return!0;let r=0,i=n-1;for(;r<=i&&e[r]==null;)r++;for(;i>=r&&e[i]==null;)i--;if(i<=r)return!0;let a=rt(1,I((i-r+1)/t));for(let t=e[r],n=r+a;n<=i;n+=a){let r=e[n];if(r!=null){if(r<=t)return!1;t=r}}return!0}var qt=[`January`,`February`,`March`,`April`,`May`,`June`,`July`,`August`,`September`,`October`,`November`,`December`],Jt=[`Sunday`,`Monday`,`Tuesday`,`Wednesday`,`Thursday`,`Friday`,`Saturday`];function Yt(e){return e.slice(0,3)}var Xt=Jt.map(Yt),Zt={MMMM:qt,MMM:qt.map(Yt),WWWW:Jt,WWW:Xt};function Qt(e){return(e<10?`0`:``)+e}function $t(e){return(e<10?`00`:e<100?`0`:``)+e}var H={YYYY:e=>e.getFullYear(),YY:e=>(e.getFullYear()+``).slice(2),MMMM:(e,t)=>t.MMMM[e.getMonth()],MMM:(e,t)=>t.MMM[e.getMonth()],MM:e=>Qt(e.getMonth()+1),M:e=>e.getMonth()+1,DD:e=>Qt(e.getDate()),D:e=>e.getDate(),WWWW:(e,t)=>t.WWWW[e.getDay()],WWW:(e,t)=>t.WWW[e.getDay()],HH:e=>Qt(e.getHours()),H:e=>e.getHours(),h:e=>{let t=e.getHours();return t==0?12:t>12?t-12:t},AA:e=>e.getHours()>=12?`PM`:`AM`,aa:e=>e.getHours()>=12?`pm`:`am`,a:e=>e.getHours()>=12?`p`:`a`,mm:e=>Qt(e.getMinutes()),m:e=>e.getMinutes(),ss:e=>Qt(e.getSeconds()),s:e=>e.getSeconds(),fff:e=>$t(e.getMilliseconds())};function en(e,t){t||=Zt;let n=[],r=/\{([a-z]+)\}|[^{]+/gi,i;for(;i=r.exec(e);)n.push(i[0][0]==`{`?H[i[1]]:i[0]);return e=>{let r=``;for(let i=0;i<n.length;i++)r+=typeof n[i]==`string`?n[i]:n[i](e,t);return r}}var U=new Intl.DateTimeFormat().resolvedOptions().timeZone;function tn(e,t){let n;return t==`UTC`||t==`Etc/UTC`?n=new Date(+e+e.getTimezoneOffset()*6e4):t==U?n=e:(n=new Date(e.toLocaleString(`en-US`,{timeZone:t})),n.setMilliseconds(e.getMilliseconds())),n}var nn=e=>e%1==0,rn=[1,2,2.5,5],an=wt(10,-32,0,rn),on=wt(10,0,32,rn),sn=on.filter(nn),cn=an.concat(on),ln=`
`,un=`{YYYY}`,dn=ln+un,fn=`{M}/{D}`,pn=ln+fn,mn=pn+`/{YY}`,hn=`{aa}`,gn=`{h}:{mm}`+hn,_n=ln+gn,vn=`:{ss}`,W=null;function yn(e){let t=e*1e3,n=t*60,r=n*60,i=r*24,a=i*30,o=i*365,s=(e==1?wt(10,0,3,rn).filter(nn):wt(10,-3,0,rn)).concat([t,t*5,t*10,t*15,t*30,n,n*5,n*10,n*15,n*30,r,r*2,r*3,r*4,r*6,r*8,r*12,i,i*2,i*3,i*4,i*5,i*6,i*7,i*8,i*9,i*10,i*15,a,a*2,a*3,a*4,a*6,o,o*2,o*5,o*10,o*25,o*50,o*100]),c=[[o,un,W,W,W,W,W,W,1],[i*28,`{MMM}`,dn,W,W,W,W,W,1],[i,fn,dn,W,W,W,W,W,1],[r,`{h}`+hn,mn,W,pn,W,W,W,1],[n,gn,mn,W,pn,W,W,W,1],[t,vn,mn+` `+gn,W,pn+` `+gn,W,_n,W,1],[e,vn+`.{fff}`,mn+` `+gn,W,pn+` `+gn,W,_n,W,1]];function l(t){return(s,c,l,u,d,f)=>{let p=[],m=d>=o,h=d>=a&&d<o,g=t(l),_=V(g*e,3),v=kn(g.getFullYear(),m?0:g.getMonth(),h||m?1:g.getDate()),y=V(v*e,3);if(h||m){let n=h?d/a:0,r=m?d/o:0,i=_==y?_:V(kn(v.getFullYear()+r,v.getMonth()+n,1)*e,3),s=new Date(et(i/e)),c=s.getFullYear(),l=s.getMonth();for(let a=0;i<=u;a++){let o=kn(c+r*a,l+n*a,1),s=o-t(V(o*e,3));i=V((+o+s)*e,3),i<=u&&p.push(i)}}else{let a=d>=i?i:d,o=y+(I(l)-I(_))+B(_-y,a);p.push(o);let m=t(o),h=m.getHours()+m.getMinutes()/n+m.getSeconds()/r,g=d/r,v=f/s.axes[c]._space;for(;o=V(o+d,e==1?0:3),!(o>u);)if(g>1){let e=I(V(h+g,6))%24,n=t(o).getHours()-e;n>1&&(n=-1),o-=n*r,h=(h+g)%24;let i=p[p.length-1];V((o-i)/d,3)*v>=.7&&p.push(o)}else p.push(o)}return p}}return[s,c,l]}var[bn,xn,Sn]=yn(1),[Cn,wn,Tn]=yn(.001);wt(2,-53,53,[1]);function En(e,t){return e.map(e=>e.map((n,r)=>r==0||r==8||n==null?n:t(r==1||e[8]==0?n:e[1]+n)))}function Dn(e,t){return(n,r,i,a,o)=>{let s=t.find(e=>o>=e[0])||t[t.length-1],c,l,u,d,f,p;return r.map(t=>{let n=e(t),r=n.getFullYear(),i=n.getMonth(),a=n.getDate(),o=n.getHours(),m=n.getMinutes(),h=n.getSeconds(),g=r!=c&&s[2]||i!=l&&s[3]||a!=u&&s[4]||o!=d&&s[5]||m!=f&&s[6]||h!=p&&s[7]||s[1];return c=r,l=i,u=a,d=o,f=m,p=h,g(n)})}}function On(e,t){let n=en(t);return(t,r,i,a,o)=>r.map(t=>n(e(t)))}function kn(e,t,n){return new Date(e,t,n)}function An(e,t){return t(e)}var jn=`{YYYY}-{MM}-{DD} {h}:{mm}{aa}`;function Mn(e,t){return(n,r,i,a)=>a==null?_e:t(e(r))}function Nn(e,t){let n=e.series[t];return n.width?n.stroke(e,t):n.points.width?n.points.stroke(e,t):null}function Pn(e,t){return e.series[t].fill(e,t)}var Fn={show:!0,live:!0,isolate:!1,mount:pt,markers:{show:!0,width:2,stroke:Nn,fill:Pn,dash:`solid`},idx:null,idxs:null,values:[]};function In(e,t){let n=e.cursor.points,r=Ee(),i=n.size(e,t);A(r,ee,i),A(r,te,i);let a=i/-2;A(r,`marginLeft`,a),A(r,`marginTop`,a);let o=n.width(e,t,i);return o&&A(r,`borderWidth`,o),r}function Ln(e,t){let n=e.series[t].points;return n._fill||n._stroke}function Rn(e,t){let n=e.series[t].points;return n._stroke||n._fill}function zn(e,t){return e.series[t].points.size}var Bn=[0,0];function Vn(e,t,n){return Bn[0]=t,Bn[1]=n,Bn}function Hn(e,t,n,r=!0){return e=>{e.button!=0||r&&e.target!=t||n(e)}}function Un(e,t,n,r=!0){return e=>{r&&e.target!=t||n(e)}}var Wn={show:!0,x:!0,y:!0,lock:!1,move:Vn,points:{one:!1,show:In,size:zn,width:0,stroke:Rn,fill:Ln},bind:{mousedown:Hn,mouseup:Hn,click:Hn,dblclick:Hn,mousemove:Un,mouseleave:Un,mouseenter:Un},drag:{setScale:!0,x:!0,y:!1,dist:0,uni:null,click:(e,t)=>{t.stopPropagation(),t.stopImmediatePropagation()},_x:!1,_y:!1},focus:{dist:(e,t,n,r,i)=>r-i,prox:-1,bias:0},hover:{skip:[void 0],prox:null,bias:0},left:-10,top:-10,idx:null,dataIdx:null,idxs:null,event:null},Gn={show:!0,stroke:`rgba(0,0,0,0.07)`,width:2},Kn=Lt({},Gn,{filter:ht}),qn=Lt({},Kn,{size:10}),Jn=Lt({},Gn,{show:!1}),Yn=`12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, "Noto Sans", sans-serif, "Apple Color Emoji", "Segoe UI Emoji", "Segoe UI Symbol", "Noto Color Emoji"`,Xn=`bold `+Yn,Zn=1.5,Qn={show:!0,scale:`x`,stroke:oe,space:50,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:Xn,side:2,grid:Kn,ticks:qn,border:Jn,font:Yn,lineGap:Zn,rotate:0},$n=`Value`,er=`Time`,tr={show:!0,scale:`x`,auto:!1,sorted:1,min:L,max:-1/0,idxs:[]};function nr(e,t,n,r,i){return t.map(e=>e==null?``:Xe(e))}function rr(e,t,n,r,i,a,o){let s=[],c=St.get(i)||0;n=o?n:V(B(n,i),c);for(let e=n;e<=r;e=V(e+i,c))s.push(Object.is(e,-0)?0:e);return s}function ir(e,t,n,r,i,a,o){let s=[],c=e.scales[e.axes[t].scale].log;i=it(c,I((c==10?ot:st)(n))),c==10&&(i=cn[Ie(i,cn)]);let l=n,u=i*c;c==10&&(u=cn[Ie(u,cn)]);do s.push(l),l+=i,c==10&&!St.has(l)&&(l=V(l,St.get(i))),l>=u&&(i=l,u=i*c,c==10&&(u=cn[Ie(u,cn)]));while(l<=r);return s}function ar(e,t,n,r,i,a,o){let s=e.scales[e.axes[t].scale].asinh,c=r>s?ir(e,t,rt(s,n),r,i):[s],l=r>=0&&n<=0?[0]:[];return(n<-s?ir(e,t,rt(s,-r),-n,i):[s]).reverse().map(e=>-e).concat(l,c)}var or=/./,sr=/[12357]/,cr=/[125]/,lr=/1/,ur=(e,t,n,r)=>e.map((e,i)=>t==4&&e==0||i%r==0&&n.test(e.toExponential()[+(e<0)])?e:null);function dr(e,t,n,r,i){let a=e.axes[n],o=a.scale,s=e.scales[o],c=e.valToPos,l=a._space,u=c(10,o),d=c(9,o)-u>=l?or:c(7,o)-u>=l?sr:c(5,o)-u>=l?cr:lr;if(d==lr){let e=$e(c(1,o)-u);if(e<l)return ur(t.slice().reverse(),s.distr,d,tt(l/e)).reverse()}return ur(t,s.distr,d,1)}function fr(e,t,n,r,i){let a=e.axes[n],o=a.scale,s=a._space,c=e.valToPos,l=$e(c(1,o)-c(2,o));return l<s?ur(t.slice().reverse(),3,or,tt(s/l)).reverse():t}function pr(e,t,n,r){return r==null?_e:t==null?``:Xe(t)}var mr={show:!0,scale:`y`,stroke:oe,space:30,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:Xn,side:3,grid:Kn,ticks:qn,border:Jn,font:Yn,lineGap:Zn,rotate:0};function hr(e,t){return V((3+(e||1)*2)*t,3)}function gr(e,t){let{scale:n,idxs:r}=e.series[0],i=e._data[0],a=e.valToPos(i[r[0]],n,!0),o=$e(e.valToPos(i[r[1]],n,!0)-a)/(e.series[t].points.space*k);return r[1]-r[0]<=o}var _r={scale:null,auto:!0,sorted:0,min:L,max:-1/0},vr=(e,t,n,r,i)=>i,yr={show:!0,auto:!0,sorted:0,gaps:vr,alpha:1,facets:[Lt({},_r,{scale:`x`}),Lt({},_r,{scale:`y`})]},br={scale:`y`,auto:!0,sorted:0,show:!0,spanGaps:!1,gaps:vr,alpha:1,points:{show:gr,filter:null},values:null,min:L,max:-1/0,idxs:[],path:null,clip:null};function xr(e,t,n,r,i){return n/10}var Sr={time:o,auto:!0,distr:1,log:10,asinh:1,min:null,max:null,dir:1,ori:0},Cr=Lt({},Sr,{time:!1,ori:1}),wr={};function Tr(e,t){let n=wr[e];return n||(n={key:e,plots:[],sub(e){n.plots.push(e)},unsub(e){n.plots=n.plots.filter(t=>t!=e)},pub(e,t,r,i,a,o,s){for(let c=0;c<n.plots.length;c++)n.plots[c]!=t&&n.plots[c].pub(e,t,r,i,a,o,s)}},e!=null&&(wr[e]=n)),n}var Er=1,Dr=2;function Or(e,t,n){let r=e.mode,i=e.series[t],a=r==2?e._data[t]:e._data,o=e.scales,s=e.bbox,c=a[0],l=r==2?a[1]:a[t],u=r==2?o[i.facets[0].scale]:o[e.series[0].scale],d=r==2?o[i.facets[1].scale]:o[i.scale],f=s.left,p=s.top,m=s.width,h=s.height,g=e.valToPosH,_=e.valToPosV;return u.ori==0?n(i,c,l,u,d,g,_,f,p,m,h,Lr,zr,Vr,Ur,Gr):n(i,c,l,u,d,_,g,p,f,h,m,Rr,Br,Hr,Wr,Kr)}function kr(e,t){let n=0,r=0,i=P(e.bands,Et);for(let e=0;e<i.length;e++){let a=i[e];a.series[0]==t?n=a.dir:a.series[1]==t&&(a.dir==1?r|=1:r|=2)}return[n,r==1?-1:r==2?1:r==3?2:0]}function Ar(e,t,n,r,i){let a=e.mode,o=e.series[t],s=a==2?o.facets[1].scale:o.scale,c=e.scales[s];return i==-1?c.min:i==1?c.max:c.distr==3?c.dir==1?c.min:c.max:0}function jr(e,t,n,r,i,a){return Or(e,t,(e,t,o,s,c,l,u,d,f,p,m)=>{let h=e.pxRound,g=s.dir*(s.ori==0?1:-1),_=s.ori==0?zr:Br,v,y;g==1?(v=n,y=r):(v=r,y=n);let b=h(l(t[v],s,p,d)),x=h(u(o[v],c,m,f)),S=h(l(t[y],s,p,d)),C=h(u(a==1?c.max:c.min,c,m,f)),w=new Path2D(i);return _(w,S,C),_(w,b,C),_(w,b,x),w})}function Mr(e,t,n,r,i,a){let o=null;if(e.length>0){o=new Path2D;let s=t==0?Vr:Hr,c=n;for(let t=0;t<e.length;t++){let n=e[t];if(n[1]>n[0]){let e=n[0]-c;e>0&&s(o,c,r,e,r+a),c=n[1]}}let l=n+i-c;l>0&&s(o,c,r-5,l,r+a+10)}return o}function Nr(e,t,n){let r=e[e.length-1];r&&r[0]==t?r[1]=n:e.push([t,n])}function Pr(e,t,n,r,i,a,o){let s=[],c=e.length;for(let l=i==1?n:r;l>=n&&l<=r;l+=i)if(t[l]===null){let u=l,d=l;if(i==1)for(;++l<=r&&t[l]===null;)d=l;else for(;--l>=n&&t[l]===null;)d=l;let f=a(e[u]),p=d==u?f:a(e[d]),m=u-i;f=o<=0&&m>=0&&m<c?a(e[m]):f;let h=d+i;p=o>=0&&h>=0&&h<c?a(e[h]):p,p>=f&&s.push([f,p])}return s}function Fr(e){return e==0?mt:e==1?et:t=>bt(t,e)}function Ir(e){let t=e==0?Lr:Rr,n=e==0?(e,t,n,r,i,a)=>{e.arcTo(t,n,r,i,a)}:(e,t,n,r,i,a)=>{e.arcTo(n,t,i,r,a)},r=e==0?(e,t,n,r,i)=>{e.rect(t,n,r,i)}:(e,t,n,r,i)=>{e.rect(n,t,i,r)};return(e,i,a,o,s,c=0,l=0)=>{c==0&&l==0?r(e,i,a,o,s):(c=nt(c,o/2,s/2),l=nt(l,o/2,s/2),t(e,i+c,a),n(e,i+o,a,i+o,a+s,c),n(e,i+o,a+s,i,a+s,l),n(e,i,a+s,i,a,l),n(e,i,a,i+o,a,c),e.closePath())}}var Lr=(e,t,n)=>{e.moveTo(t,n)},Rr=(e,t,n)=>{e.moveTo(n,t)},zr=(e,t,n)=>{e.lineTo(t,n)},Br=(e,t,n)=>{e.lineTo(n,t)},Vr=Ir(0),Hr=Ir(1),Ur=(e,t,n,r,i,a)=>{e.arc(t,n,r,i,a)},Wr=(e,t,n,r,i,a)=>{e.arc(n,t,r,i,a)},Gr=(e,t,n,r,i,a,o)=>{e.bezierCurveTo(t,n,r,i,a,o)},Kr=(e,t,n,r,i,a,o)=>{e.bezierCurveTo(n,t,i,r,o,a)};function qr(e){return(e,t,n,r,i)=>Or(e,t,(t,a,o,s,c,l,u,d,f,p,m)=>{let{pxRound:h,points:g}=t,_,v;s.ori==0?(_=Lr,v=Ur):(_=Rr,v=Wr);let y=V(g.width*k,3),b=(g.size-g.width)/2*k,x=V(b*2,3),S=new Path2D,C=new Path2D,{left:w,top:T,width:E,height:ee}=e.bbox;Vr(C,w-x,T-x,E+x*2,ee+x*2);let te=e=>{if(o[e]!=null){let t=h(l(a[e],s,p,d)),n=h(u(o[e],c,m,f));_(S,t+b,n),v(S,t,n,b,0,Qe*2)}};if(i)i.forEach(te);else for(let e=n;e<=r;e++)te(e);return{stroke:y>0?S:null,fill:S,clip:C,flags:3}})}function Jr(e){return(t,n,r,i,a,o)=>{r!=i&&(a!=r&&o!=r&&e(t,n,r),a!=i&&o!=i&&e(t,n,i),e(t,n,o))}}var Yr=Jr(zr),Xr=Jr(Br);function Zr(e){let t=P(e?.alignGaps,0);return(e,n,r,i)=>Or(e,n,(a,o,s,c,l,u,d,f,p,m,h)=>{[r,i]=Re(s,r,i);let g=a.pxRound,_=e=>g(u(e,c,m,f)),v=e=>g(d(e,l,h,p)),y,b;c.ori==0?(y=zr,b=Yr):(y=Br,b=Xr);let x=c.dir*(c.ori==0?1:-1),S={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Er},C=S.stroke,w=!1;if(i-r>=m*4){let t=t=>e.posToVal(t,c.key,!0),n=null,a=null,l,u,d,f=_(o[x==1?r:i]),p=_(o[r]),m=_(o[i]),h=t(x==1?p+1:m-1);for(let e=x==1?r:i;e>=r&&e<=i;e+=x){let r=o[e],i=(x==1?r<h:r>h)?f:_(r),c=s[e];i==f?c==null?c===null&&(w=!0):(u=c,n==null?(y(C,i,v(u)),l=n=a=u):u<n?n=u:u>a&&(a=u)):(n!=null&&b(C,f,v(n),v(a),v(l),v(u)),c==null?(n=a=null,c===null&&(w=!0)):(u=c,y(C,i,v(u)),n=a=l=u),f=i,h=t(f+x))}n!=null&&n!=a&&d!=f&&b(C,f,v(n),v(a),v(l),v(u))}else for(let e=x==1?r:i;e>=r&&e<=i;e+=x){let t=s[e];t===null?w=!0:t!=null&&y(C,_(o[e]),v(t))}let[T,E]=kr(e,n);if(a.fill!=null||T!=0){let t=S.fill=new Path2D(C),s=v(a.fillTo(e,n,a.min,a.max,T)),c=_(o[r]),l=_(o[i]);x==-1&&([l,c]=[c,l]),y(t,l,s),y(t,c,s)}if(!a.spanGaps){let l=[];w&&l.push(...Pr(o,s,r,i,x,_,t)),S.gaps=l=a.gaps(e,n,r,i,l),S.clip=Mr(l,c.ori,f,p,m,h)}return E!=0&&(S.band=E==2?[jr(e,n,r,i,C,-1),jr(e,n,r,i,C,1)]:jr(e,n,r,i,C,E)),S})}function Qr(e){let t=P(e.align,1),n=P(e.ascDesc,!1),r=P(e.alignGaps,0),i=P(e.extend,!1);return(e,a,o,s)=>Or(e,a,(c,l,u,d,f,p,m,h,g,_,v)=>{[o,s]=Re(u,o,s);let y=c.pxRound,{left:b,width:x}=e.bbox,S=e=>y(p(e,d,_,h)),C=e=>y(m(e,f,v,g)),w=d.ori==0?zr:Br,T={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:Er},E=T.stroke,ee=d.dir*(d.ori==0?1:-1),te=C(u[ee==1?o:s]),ne=S(l[ee==1?o:s]),re=ne,ie=ne;i&&t==-1&&(ie=b,w(E,ie,te)),w(E,ne,te);for(let e=ee==1?o:s;e>=o&&e<=s;e+=ee){let n=u[e];if(n==null)continue;let r=S(l[e]),i=C(n);t==1?w(E,r,te):w(E,re,i),w(E,r,i),te=i,re=r}let ae=re;i&&t==1&&(ae=b+x,w(E,ae,te));let[oe,se]=kr(e,a);if(c.fill!=null||oe!=0){let t=T.fill=new Path2D(E),n=C(c.fillTo(e,a,c.min,c.max,oe));w(t,ae,n),w(t,ie,n)}if(!c.spanGaps){let i=[];i.push(...Pr(l,u,o,s,ee,S,r));let f=c.width*k/2,p=n||t==1?f:-f,m=n||t==-1?-f:f;i.forEach(e=>{e[0]+=p,e[1]+=m}),T.gaps=i=c.gaps(e,a,o,s,i),T.clip=Mr(i,d.ori,h,g,_,v)}return se!=0&&(T.band=se==2?[jr(e,a,o,s,E,-1),jr(e,a,o,s,E,1)]:jr(e,a,o,s,E,se)),T})}function $r(e,t,n,r,i,a,o=L){if(e.length>1){let s=null;for(let c=0,l=1/0;c<e.length;c++)if(t[c]!==void 0){if(s!=null){let t=$e(e[c]-e[s]);t<l&&(l=t,o=$e(n(e[c],r,i,a)-n(e[s],r,i,a)))}s=c}}return o}function ei(e){e||=Tt;let t=P(e.size,[.6,L,1]),n=e.align||0,r=e.gap||0,i=e.radius;i=i==null?[0,0]:typeof i==`number`?[i,0]:i;let a=R(i),o=1-t[0],s=P(t[1],L),c=P(t[2],1),l=P(e.disp,Tt),u=P(e.each,e=>{}),{fill:d,stroke:f}=l;return(e,t,i,p)=>Or(e,t,(m,h,g,_,v,y,b,x,S,C,w)=>{let T=m.pxRound,E=n,ee=r*k,te=s*k,ne=c*k,re,ie;_.ori==0?[re,ie]=a(e,t):[ie,re]=a(e,t);let ae=_.dir*(_.ori==0?1:-1),oe=_.ori==0?Vr:Hr,se=_.ori==0?u:(e,t,n,r,i,a,o)=>{u(e,t,n,i,r,o,a)},ce=P(e.bands,Et).find(e=>e.series[0]==t),le=ce==null?0:ce.dir,ue=m.fillTo(e,t,m.min,m.max,le),de=T(b(ue,v,w,S)),fe,pe,me,he=C,D=T(m.width*k),ge=!1,_e=null,O=null,ve=null,ye=null;d!=null&&(D==0||f!=null)&&(ge=!0,_e=d.values(e,t,i,p),O=new Map,new Set(_e).forEach(e=>{e!=null&&O.set(e,new Path2D)}),D>0&&(ve=f.values(e,t,i,p),ye=new Map,new Set(ve).forEach(e=>{e!=null&&ye.set(e,new Path2D)})));let{x0:be,size:xe}=l;if(be!=null&&xe!=null){E=1,h=be.values(e,t,i,p),be.unit==2&&(h=h.map(t=>e.posToVal(x+t*C,_.key,!0)));let n=xe.values(e,t,i,p);pe=xe.unit==2?n[0]*C:y(n[0],_,C,x)-y(0,_,C,x),he=$r(h,g,y,_,C,x,he),me=he-pe+ee}else he=$r(h,g,y,_,C,x,he),me=he*o+ee,pe=he-me;me<1&&(me=0),D>=pe/2&&(D=0),me<5&&(T=mt);let Se=me>0,Ce=he-me-(Se?D:0);pe=T(dt(Ce,ne,te)),fe=(E==0?pe/2:E==ae?0:pe)-E*ae*((E==0?ee/2:0)+(Se?D/2:0));let we={stroke:null,fill:null,clip:null,band:null,gaps:null,flags:0},A=ge?null:new Path2D,Te=null;if(ce!=null)Te=e.data[ce.series[1]];else{let{y0:n,y1:r}=l;n!=null&&r!=null&&(g=r.values(e,t,i,p),Te=n.values(e,t,i,p))}let Ee=re*pe,De=ie*pe;for(let n=ae==1?i:p;n>=i&&n<=p;n+=ae){let r=g[n];if(r==null)continue;if(Te!=null){let e=Te[n]??0;if(r-e==0)continue;de=b(e,v,w,S)}let i=y(_.distr!=2||l!=null?h[n]:n,_,C,x),a=b(P(r,ue),v,w,S),o=T(i-fe),s=T(rt(a,de)),c=T(nt(a,de)),u=s-c;if(r!=null){let i=r<0?De:Ee,a=r<0?Ee:De;ge?(D>0&&ve[n]!=null&&oe(ye.get(ve[n]),o,c+I(D/2),pe,rt(0,u-D),i,a),_e[n]!=null&&oe(O.get(_e[n]),o,c+I(D/2),pe,rt(0,u-D),i,a)):oe(A,o,c+I(D/2),pe,rt(0,u-D),i,a),se(e,t,n,o-D/2,c,pe+D,u)}}return D>0?we.stroke=ge?ye:A:ge||(we._fill=m.width==0?m._fill:m._stroke??m._fill,we.width=0),we.fill=ge?O:A,we})}function ti(e,t){let n=P(t?.alignGaps,0);return(t,r,i,a)=>Or(t,r,(o,s,c,l,u,d,f,p,m,h,g)=>{[i,a]=Re(c,i,a);let _=o.pxRound,v=e=>_(d(e,l,h,p)),y=e=>_(f(e,u,g,m)),b,x,S;l.ori==0?(b=Lr,S=zr,x=Gr):(b=Rr,S=Br,x=Kr);let C=l.dir*(l.ori==0?1:-1),w=v(s[C==1?i:a]),T=w,E=[],ee=[];for(let e=C==1?i:a;e>=i&&e<=a;e+=C)if(c[e]!=null){let t=s[e],n=v(t);E.push(T=n),ee.push(y(c[e]))}let te={stroke:e(E,ee,b,S,x,_),fill:null,clip:null,band:null,gaps:null,flags:Er},ne=te.stroke,[re,ie]=kr(t,r);if(o.fill!=null||re!=0){let e=te.fill=new Path2D(ne),n=y(o.fillTo(t,r,o.min,o.max,re));S(e,T,n),S(e,w,n)}if(!o.spanGaps){let e=[];e.push(...Pr(s,c,i,a,C,v,n)),te.gaps=e=o.gaps(t,r,i,a,e),te.clip=Mr(e,l.ori,p,m,h,g)}return ie!=0&&(te.band=ie==2?[jr(t,r,i,a,ne,-1),jr(t,r,i,a,ne,1)]:jr(t,r,i,a,ne,ie)),te})}function ni(e){return ti(ri,e)}function ri(e,t,n,r,i,a){let o=e.length;if(o<2)return null;let s=new Path2D;if(n(s,e[0],t[0]),o==2)r(s,e[1],t[1]);else{let n=Array(o),r=Array(o-1),a=Array(o-1),c=Array(o-1);for(let n=0;n<o-1;n++)a[n]=t[n+1]-t[n],c[n]=e[n+1]-e[n],r[n]=a[n]/c[n];n[0]=r[0];for(let e=1;e<o-1;e++)r[e]===0||r[e-1]===0||r[e-1]>0!=r[e]>0?n[e]=0:(n[e]=3*(c[e-1]+c[e])/((2*c[e]+c[e-1])/r[e-1]+(c[e]+2*c[e-1])/r[e]),isFinite(n[e])||(n[e]=0));n[o-1]=r[o-2];for(let r=0;r<o-1;r++)i(s,e[r]+c[r]/3,t[r]+n[r]*c[r]/3,e[r+1]-c[r]/3,t[r+1]-n[r+1]*c[r]/3,e[r+1],t[r+1])}return s}var ii=new Set;function ai(){for(let e of ii)e.syncRect(!0)}O&&(Pe(me,ye,ai),Pe(he,ye,ai,!0),Pe(ge,ye,()=>{xi.pxRatio=k}));var oi=Zr(),si=qr();function ci(e,t,n,r){return(r?[e[0],e[1]].concat(e.slice(2)):[e[0]].concat(e.slice(1))).map((e,r)=>ui(e,r,t,n))}function li(e,t){return e.map((e,n)=>n==0?{}:Lt({},t,e))}function ui(e,t,n,r){return Lt({},t==0?n:r,e)}function di(e,t,n){return t==null?Dt:[t,n]}var fi=di;function pi(e,t,n){return t==null?Dt:qe(t,n,Ue,!0)}function mi(e,t,n,r){return t==null?Dt:Ve(t,n,e.scales[r].log,!1)}var hi=mi;function gi(e,t,n,r){return t==null?Dt:He(t,n,e.scales[r].log,!1)}var _i=gi;function vi(e,t,n,r,i){let a=rt(ut(e),ut(t)),o=t-e,s=Ie(i/r*o,n);do{let e=n[s],t=r*e/o;if(t>=i&&a+(e<5?St.get(e):0)<=17)return[e,t]}while(++s<n.length);return[0,0]}function yi(e){let t,n;return e=e.replace(/(\d+)px/,(e,r)=>(t=et((n=+r)*k))+`px`),[e,t,n]}function bi(e){e.show&&[e.font,e.labelFont].forEach(e=>{let t=V(e[2]*k,1);e[0]=e[0].replace(/[0-9.]+px/,t+`px`),e[1]=t})}function xi(e,t,n){let r={mode:P(e.mode,1)},i=r.mode;function a(e,t,n,r){let i=t.valToPct(e);return r+n*(t.dir==-1?1-i:i)}function o(e,t,n,r){let i=t.valToPct(e);return r+n*(t.dir==-1?i:1-i)}function oe(e,t,n,r){return t.ori==0?a(e,t,n,r):o(e,t,n,r)}r.valToPosH=a,r.valToPosV=o;let me=!1;r.status=0;let he=r.root=Ee(s);if(e.id!=null&&(he.id=e.id),Ce(he,e.class),e.title){let t=Ee(u,he);t.textContent=e.title}let D=Te(`canvas`),O=r.ctx=D.getContext(`2d`),be=Ee(d,he);Pe(`click`,be,e=>{e.target===Se&&(G!=Ri||K!=zi)&&Ui.click(r,e)},!0);let xe=r.under=Ee(f,be);be.appendChild(D);let Se=r.over=Ee(p,be);e=It(e);let De=+P(e.pxAlign,1),ke=Fr(De);(e.plugins||[]).forEach(t=>{t.opts&&(e=t.opts(r,e)||e)});let je=e.ms||.001,j=r.series=i==1?ci(e.series||[],tr,br,!1):li(e.series||[null],yr),Ne=r.axes=ci(e.axes||[],Qn,mr,!0),M=r.scales={},Le=r.bands=e.bands||[];Le.forEach(e=>{e.fill=R(e.fill||null),e.dir=P(e.dir,-1)});let N=i==2?j[1].facets[0].scale:j[0].scale,Re={axes:Si,series:Yr},ze=(e.drawOrder||[`axes`,`series`]).map(e=>Re[e]);function Ge(e){let t=e.distr==3?t=>ot(t>0?t:e.clamp(r,t,e.min,e.max,e.key)):e.distr==4?t=>lt(t,e.asinh):e.distr==100?t=>e.fwd(t):e=>e;return n=>{let r=t(n),{_min:i,_max:a}=e,o=a-i;return(r-i)/o}}function Ke(t){let n=M[t];if(n==null){let r=(e.scales||Tt)[t]||Tt;if(r.from!=null){Ke(r.from);let e=Lt({},M[r.from],r,{key:t});e.valToPct=Ge(e),M[t]=e}else{n=M[t]=Lt({},t==N?Sr:Cr,r),n.key=t;let e=n.time,a=n.range,o=Ot(a);if((t!=N||i==2&&!e)&&(o&&(a[0]==null||a[1]==null)&&(a={min:a[0]==null?We:{mode:1,hard:a[0],soft:a[0]},max:a[1]==null?We:{mode:1,hard:a[1],soft:a[1]}},o=!1),!o&&Mt(a))){let e=a;a=(t,n,r)=>n==null?Dt:qe(n,r,e)}n.range=R(a||(e?fi:t==N?n.distr==3?hi:n.distr==4?_i:di:n.distr==3?mi:n.distr==4?gi:pi)),n.auto=R(!o&&n.auto),n.clamp=R(n.clamp||xr),n._min=n._max=null,n.valToPct=Ge(n)}}}Ke(`x`),Ke(`y`),i==1&&j.forEach(e=>{Ke(e.scale)}),Ne.forEach(e=>{Ke(e.scale)});for(let t in e.scales)Ke(t);let F=M[N],Ye=F.distr,Xe,Ze;F.ori==0?(Ce(he,c),Xe=a,Ze=o):(Ce(he,l),Xe=o,Ze=a);let I={};for(let e in M){let t=M[e];(t.min!=null||t.max!=null)&&(I[e]={min:t.min,max:t.max},t.min=t.max=null)}let at=e.tzDate||(e=>new Date(et(e/je))),st=e.fmtDate||en,ut=je==1?Sn(at):Tn(at),pt=Dn(at,En(je==1?xn:wn,st)),mt=Mn(at,An(jn,st)),yt=[],z=r.legend=Lt({},Fn,e.legend),B=r.cursor=Lt({},Wn,{drag:{y:i==2}},e.cursor),xt=z.show,wt=B.show,kt=z.markers;z.idxs=yt,kt.width=R(kt.width),kt.dash=R(kt.dash),kt.stroke=R(kt.stroke),kt.fill=R(kt.fill);let Pt,Ft,Rt,zt=[],Bt=[],Vt,Ht=!1,Wt={};if(z.live){let e=j[1]?j[1].values:null;Ht=e!=null,Vt=Ht?e(r,1,0):{_:0};for(let e in Vt)Wt[e]=_e}if(xt){if(Pt=Te(`table`,b,he),Rt=Te(`tbody`,null,Pt),z.mount(r,Pt),Ht){Ft=Te(`thead`,null,Pt,Rt);let e=Te(`tr`,null,Ft);for(var Gt in Te(`th`,null,e),Vt)Te(`th`,T,e).textContent=Gt}else Ce(Pt,S),z.live&&Ce(Pt,x)}let Kt={show:!0},qt={show:!1};function Jt(e,t){if(t==0&&(Ht||!z.live||i==2))return Dt;let n=[],a=Te(`tr`,C,Rt,Rt.childNodes[t]);Ce(a,e.class),e.show||Ce(a,h);let o=Te(`th`,null,a);if(kt.show){let e=Ee(w,o);if(t>0){let n=kt.width(r,t);n&&(e.style.border=n+`px `+kt.dash(r,t)+` `+kt.stroke(r,t)),e.style.background=kt.fill(r,t)}}let s=Ee(T,o);for(var c in e.label instanceof HTMLElement?s.appendChild(e.label):s.textContent=e.label,t>0&&(kt.show||(s.style.color=e.width>0?kt.stroke(r,t):kt.fill(r,t)),Xt(`click`,o,t=>{if(B._lock)return;Rn(t);let n=j.indexOf(e);if((t.ctrlKey||t.metaKey)!=z.isolate){let e=j.some((e,t)=>t>0&&t!=n&&e.show);j.forEach((t,r)=>{r>0&&Y(r,e?r==n?Kt:qt:Kt,!0,$.setSeries)})}else Y(n,{show:!e.show},!0,$.setSeries)},!1),Vn&&Xt(de,o,t=>{B._lock||(Rn(t),Y(j.indexOf(e),na,!0,$.setSeries))},!1)),Vt){let e=Te(`td`,E,a);e.textContent=`--`,n.push(e)}return[a,n]}let Yt=new Map;function Xt(e,t,n,i=!0){let a=Yt.get(t)||{},o=B.bind[e](r,t,n,i);o&&(Pe(e,t,a[e]=o),Yt.set(t,a))}function Zt(e,t,n){let r=Yt.get(t)||{};for(let n in r)(e==null||n==e)&&(Fe(n,t,r[n]),delete r[n]);e??Yt.delete(t)}let Qt=0,$t=0,H=0,U=0,tn=0,nn=0,rn=tn,an=nn,on=H,ln=U,un=0,dn=0,fn=0,pn=0;r.bbox={};let mn=!1,hn=!1,gn=!1,_n=!1,vn=!1,W=!1;function yn(e,t,n){(n||e!=r.width||t!=r.height)&&kn(e,t),Ci(!1),gn=!0,hn=!0,Oi()}function kn(e,t){r.width=Qt=H=e,r.height=$t=U=t,tn=nn=0,In(),Ln();let n=r.bbox;un=n.left=bt(tn*k,.5),dn=n.top=bt(nn*k,.5),fn=n.width=bt(H*k,.5),pn=n.height=bt(U*k,.5)}function Nn(){let e=!1,t=0;for(;!e;){t++;let n=ai(t),i=xi(t);e=t==3||n&&i,e||(kn(r.width,r.height),hn=!0)}}function Pn({width:e,height:t}){yn(e,t)}r.setSize=Pn;function In(){let e=!1,t=!1,n=!1,r=!1;Ne.forEach((i,a)=>{if(i.show&&i._show){let{side:a,_size:o}=i,s=a%2,c=o+(i.label==null?0:i.labelSize);c>0&&(s?(H-=c,a==3?(tn+=c,r=!0):n=!0):(U-=c,a==0?(nn+=c,e=!0):t=!0))}}),Zn[0]=e,Zn[1]=n,Zn[2]=t,Zn[3]=r,H-=lr[1]+lr[3],tn+=lr[3],U-=lr[2]+lr[0],nn+=lr[0]}function Ln(){let e=tn+H,t=nn+U,n=tn,r=nn;function i(i,a){switch(i){case 1:return e+=a,e-a;case 2:return t+=a,t-a;case 3:return n-=a,n+a;case 0:return r-=a,r+a}}Ne.forEach((e,t)=>{if(e.show&&e._show){let t=e.side;e._pos=i(t,e._size),e.label!=null&&(e._lpos=i(t,e.labelSize))}})}if(B.dataIdx==null){let e=B.hover,n=e.skip=new Set(e.skip??[]);n.add(void 0);let r=e.prox=R(e.prox),i=e.bias??=0;B.dataIdx=(e,a,o,s)=>{if(a==0)return o;let c=o,l=r(e,a,o,s)??L,u=l>=0&&l<L,d=F.ori==0?H:U,f=B.left,p=t[0],m=t[a];if(n.has(m[o])){c=null;let e=null,t=null,r;if(i==0||i==-1)for(r=o;e==null&&r-->0;)n.has(m[r])||(e=r);if(i==0||i==1)for(r=o;t==null&&r++<m.length;)n.has(m[r])||(t=r);if(e!=null||t!=null){if(u){let n=e==null?-1/0:Xe(p[e],F,d,0),r=t==null?1/0:Xe(p[t],F,d,0),i=f-n,a=r-f;i<=a?i<=l&&(c=e):a<=l&&(c=t)}else c=t==null?e:e==null?t:o-e<=t-o?e:t}}else u&&$e(f-Xe(p[o],F,d,0))>l&&(c=null);return c}}let Rn=e=>{B.event=e};B.idxs=yt,B._lock=!1;let zn=B.points;zn.show=R(zn.show),zn.size=R(zn.size),zn.stroke=R(zn.stroke),zn.width=R(zn.width),zn.fill=R(zn.fill);let Bn=r.focus=Lt({},e.focus||{alpha:.3},B.focus),Vn=Bn.prox>=0,Hn=Vn&&zn.one,Un=[],Gn=[],Kn=[];function qn(e,t){let n=zn.show(r,t);if(n instanceof HTMLElement)return Ce(n,y),Ce(n,e.class),Oe(n,-10,-10,H,U),Se.insertBefore(n,Un[t]),n}function Jn(e,t){if(i==1||t>0){let t=i==1&&M[e.scale].time,n=e.value;e.value=t?jt(n)?Mn(at,An(n,st)):n||mt:n||pr,e.label=e.label||(t?er:$n)}if(Hn||t>0){e.width=e.width==null?1:e.width,e.paths=e.paths||oi||gt,e.fillTo=R(e.fillTo||Ar),e.pxAlign=+P(e.pxAlign,De),e.pxRound=Fr(e.pxAlign),e.stroke=R(e.stroke||null),e.fill=R(e.fill||null),e._stroke=e._fill=e._paths=e._focus=null;let t=hr(rt(1,e.width),1),n=e.points=Lt({},{size:t,width:rt(1,t*.2),stroke:e.stroke,space:t*2,paths:si,_stroke:null,_fill:null},e.points);n.show=R(n.show),n.filter=R(n.filter),n.fill=R(n.fill),n.stroke=R(n.stroke),n.paths=R(n.paths),n.pxAlign=e.pxAlign}if(xt){let n=Jt(e,t);zt.splice(t,0,n[0]),Bt.splice(t,0,n[1]),z.values.push(null)}if(wt){yt.splice(t,0,null);let n=null;Hn?t==0&&(n=qn(e,t)):t>0&&(n=qn(e,t)),Un.splice(t,0,n),Gn.splice(t,0,0),Kn.splice(t,0,0)}Q(`addSeries`,t)}function Yn(e,t){t??=j.length,e=i==1?ui(e,t,tr,br):ui(e,t,{},yr),j.splice(t,0,e),Jn(j[t],t)}r.addSeries=Yn;function Xn(e){if(j.splice(e,1),xt){z.values.splice(e,1),Bt.splice(e,1);let t=zt.splice(e,1)[0];Zt(null,t.firstChild),t.remove()}wt&&(yt.splice(e,1),Un.splice(e,1)[0].remove(),Gn.splice(e,1),Kn.splice(e,1)),Q(`delSeries`,e)}r.delSeries=Xn;let Zn=[!1,!1,!1,!1];function or(e,t){if(e._show=e.show,e.show){let n=e.side%2,i=M[e.scale];i??=(e.scale=n?j[1].scale:N,M[e.scale]);let a=i.time;e.size=R(e.size),e.space=R(e.space),e.rotate=R(e.rotate),Ot(e.incrs)&&e.incrs.forEach(e=>{!St.has(e)&&St.set(e,Ct(e))}),e.incrs=R(e.incrs||(i.distr==2?sn:a?je==1?bn:Cn:cn)),e.splits=R(e.splits||(a&&i.distr==1?ut:i.distr==3?ir:i.distr==4?ar:rr)),e.stroke=R(e.stroke),e.grid.stroke=R(e.grid.stroke),e.ticks.stroke=R(e.ticks.stroke),e.border.stroke=R(e.border.stroke);let o=e.values;e.values=Ot(o)&&!Ot(o[0])?R(o):a?Ot(o)?Dn(at,En(o,st)):jt(o)?On(at,o):o||pt:o||nr,e.filter=R(e.filter||(i.distr>=3&&i.log==10?dr:i.distr==3&&i.log==2?fr:ht)),e.font=yi(e.font),e.labelFont=yi(e.labelFont),e._size=e.size(r,null,t,0),e._space=e._rotate=e._incrs=e._found=e._splits=e._values=null,e._size>0&&(Zn[t]=!0,e._el=Ee(m,be))}}function sr(e,t,n,r){let[i,a,o,s]=n,c=t%2,l=0;return c==0&&(s||a)&&(l=t==0&&!i||t==2&&!o?et(Qn.size/3):0),c==1&&(i||o)&&(l=t==1&&!a||t==3&&!s?et(mr.size/2):0),l}let cr=r.padding=(e.padding||[sr,sr,sr,sr]).map(e=>R(P(e,sr))),lr=r._padding=cr.map((e,t)=>e(r,t,Zn,0)),ur,gr=null,_r=null,vr=i==1?j[0].idxs:null,wr=null,Or=!1;function kr(e,n){if(t=e??[],r.data=r._data=t,i==2){ur=0;for(let e=1;e<j.length;e++)ur+=t[e][0].length}else{t.length==0&&(r.data=r._data=t=[[]]),wr=t[0],ur=wr.length;let e=t;if(Ye==2){e=t.slice();let n=e[0]=Array(ur);for(let e=0;e<ur;e++)n[e]=e}r._data=t=e}if(Ci(!0),Q(`setData`),Ye==2&&(gn=!0),n!==!1){let e=F;e.auto(r,Or)?jr():J(N,e.min,e.max),_n||=B.left>=0,W=!0,Oi()}}r.setData=kr;function jr(){Or=!0;let e,n;i==1&&(ur>0?(gr=vr[0]=0,_r=vr[1]=ur-1,e=t[0][gr],n=t[0][_r],Ye==2?(e=gr,n=_r):e==n&&(Ye==3?[e,n]=Ve(e,e,F.log,!1):Ye==4?[e,n]=He(e,e,F.log,!1):F.time?n=e+et(86400/je):[e,n]=qe(e,n,Ue,!0))):(gr=vr[0]=e=null,_r=vr[1]=n=null)),J(N,e,n)}let Mr,Nr,Pr,Ir,Lr,Rr,zr,Br,Vr,Hr;function Ur(e,t,n,r,i,a){e??=se,n??=Et,r??=`butt`,i??=se,a??=`round`,e!=Mr&&(O.strokeStyle=Mr=e),i!=Nr&&(O.fillStyle=Nr=i),t!=Pr&&(O.lineWidth=Pr=t),a!=Lr&&(O.lineJoin=Lr=a),r!=Rr&&(O.lineCap=Rr=r),n!=Ir&&O.setLineDash(Ir=n)}function Wr(e,t,n,r){t!=Nr&&(O.fillStyle=Nr=t),e!=zr&&(O.font=zr=e),n!=Br&&(O.textAlign=Br=n),r!=Vr&&(O.textBaseline=Vr=r)}function Gr(e,t,n,i,a=0){if(i.length>0&&e.auto(r,Or)&&(t==null||t.min==null)){let t=P(gr,0),r=P(_r,i.length-1),o=n.min==null?Be(i,t,r,a,e.distr==3):[n.min,n.max];e.min=nt(e.min,n.min=o[0]),e.max=rt(e.max,n.max=o[1])}}let Kr={min:null,max:null};function qr(){for(let e in M){let t=M[e];I[e]==null&&(t.min==null||I[N]!=null&&t.auto(r,Or))&&(I[e]=Kr)}for(let e in M){let t=M[e];I[e]==null&&t.from!=null&&I[t.from]!=null&&(I[e]=Kr)}I[N]!=null&&Ci(!0);let e={};for(let t in I){let n=I[t];if(n!=null){let a=e[t]=It(M[t],Nt);if(n.min!=null)Lt(a,n);else if(t!=N||i==2){if(ur==0&&a.from==null){let e=a.range(r,null,null,t);a.min=e[0],a.max=e[1]}else a.min=L,a.max=-1/0}}}if(ur>0){j.forEach((n,a)=>{if(i==1){let i=n.scale,o=I[i];if(o==null)return;let s=e[i];if(a==0){let e=s.range(r,s.min,s.max,i);s.min=e[0],s.max=e[1],gr=Ie(s.min,t[0]),_r=Ie(s.max,t[0]),_r-gr>1&&(t[0][gr]<s.min&&gr++,t[0][_r]>s.max&&_r--),n.min=wr[gr],n.max=wr[_r]}else n.show&&n.auto&&Gr(s,o,n,t[a],n.sorted);n.idxs[0]=gr,n.idxs[1]=_r}else if(a>0&&n.show&&n.auto){let[r,i]=n.facets,o=r.scale,s=i.scale,[c,l]=t[a],u=e[o],d=e[s];u!=null&&Gr(u,I[o],r,c,r.sorted),d!=null&&Gr(d,I[s],i,l,i.sorted),n.min=i.min,n.max=i.max}});for(let t in e){let n=e[t],i=I[t];if(n.from==null&&(i==null||i.min==null)){let e=n.range(r,n.min==L?null:n.min,n.max==-1/0?null:n.max,t);n.min=e[0],n.max=e[1]}}}for(let t in e){let n=e[t];if(n.from!=null){let i=e[n.from];if(i.min==null)n.min=n.max=null;else{let e=n.range(r,i.min,i.max,t);n.min=e[0],n.max=e[1]}}}let n={},a=!1;for(let t in e){let r=e[t],i=M[t];if(i.min!=r.min||i.max!=r.max){i.min=r.min,i.max=r.max;let e=i.distr;i._min=e==3?ot(i.min):e==4?lt(i.min,i.asinh):e==100?i.fwd(i.min):i.min,i._max=e==3?ot(i.max):e==4?lt(i.max,i.asinh):e==100?i.fwd(i.max):i.max,n[t]=a=!0}}if(a){j.forEach((e,t)=>{i==2?t>0&&n.y&&(e._paths=null):n[e.scale]&&(e._paths=null)});for(let e in n)gn=!0,Q(`setScale`,e);wt&&B.left>=0&&(_n=W=!0)}for(let e in I)I[e]=null}function Jr(e){let t=dt(gr-1,0,ur-1),n=dt(_r+1,0,ur-1);for(;e[t]==null&&t>0;)t--;for(;e[n]==null&&n<ur-1;)n++;return[t,n]}function Yr(){if(ur>0){let e=j.some(e=>e._focus)&&Hr!=Bn.alpha;e&&(O.globalAlpha=Hr=Bn.alpha),j.forEach((e,n)=>{if(n>0&&e.show&&(Xr(n,!1),Xr(n,!0),e._paths==null)){let a=Hr;Hr!=e.alpha&&(O.globalAlpha=Hr=e.alpha);let o=i==2?[0,t[n][0].length-1]:Jr(t[n]);e._paths=e.paths(r,n,o[0],o[1]),Hr!=a&&(O.globalAlpha=Hr=a)}}),j.forEach((e,t)=>{if(t>0&&e.show){let n=Hr;Hr!=e.alpha&&(O.globalAlpha=Hr=e.alpha),e._paths!=null&&Zr(t,!1);{let n=e._paths==null?null:e._paths.gaps,i=e.points.show(r,t,gr,_r,n),a=e.points.filter(r,t,i,n);(i||a)&&(e.points._paths=e.points.paths(r,t,gr,_r,a),Zr(t,!0))}Hr!=n&&(O.globalAlpha=Hr=n),Q(`drawSeries`,t)}}),e&&(O.globalAlpha=Hr=1)}}function Xr(e,t){let n=t?j[e].points:j[e];n._stroke=n.stroke(r,e),n._fill=n.fill(r,e)}function Zr(e,t){let n=t?j[e].points:j[e],{stroke:r,fill:i,clip:a,flags:o,_stroke:s=n._stroke,_fill:c=n._fill,_width:l=n.width}=n._paths;l=V(l*k,3);let u=null,d=l%2/2;t&&c==null&&(c=l>0?`#fff`:s);let f=n.pxAlign==1&&d>0;if(f&&O.translate(d,d),!t){let e=un-l/2,t=dn-l/2,n=fn+l,r=pn+l;u=new Path2D,u.rect(e,t,n,r)}t?$r(s,l,n.dash,n.cap,c,r,i,o,a):Qr(e,s,l,n.dash,n.cap,c,r,i,o,u,a),f&&O.translate(-d,-d)}function Qr(e,n,i,a,o,s,c,l,u,d,f){let p=!1;u!=0&&Le.forEach((m,h)=>{if(m.series[0]==e){let e=j[m.series[1]],g=t[m.series[1]],_=(e._paths||Tt).band;Ot(_)&&(_=m.dir==1?_[0]:_[1]);let v,y=null;e.show&&_&&Je(g,gr,_r)?(y=m.fill(r,h)||s,v=e._paths.clip):_=null,$r(n,i,a,o,y,c,l,u,d,f,v,_),p=!0}}),p||$r(n,i,a,o,s,c,l,u,d,f)}function $r(e,t,n,r,i,a,o,s,c,l,u,d){Ur(e,t,n,r,i),(c||l||d)&&(O.save(),c&&O.clip(c),l&&O.clip(l)),d?(s&3)==3?(O.clip(d),u&&O.clip(u),ti(i,o),ei(e,a,t)):s&Dr?(ti(i,o),O.clip(d),ei(e,a,t)):s&Er&&(O.save(),O.clip(d),u&&O.clip(u),ti(i,o),O.restore(),ei(e,a,t)):(ti(i,o),ei(e,a,t)),(c||l||d)&&O.restore()}function ei(e,t,n){n>0&&(t instanceof Map?t.forEach((e,t)=>{O.strokeStyle=Mr=t,O.stroke(e)}):t!=null&&e&&O.stroke(t))}function ti(e,t){t instanceof Map?t.forEach((e,t)=>{O.fillStyle=Nr=t,O.fill(e)}):t!=null&&e&&O.fill(t)}function ni(e,t,n,i){let a=Ne[e],o;if(i<=0)o=[0,0];else{let s=a._space=a.space(r,e,t,n,i);o=vi(t,n,a._incrs=a.incrs(r,e,t,n,i,s),i,s)}return a._found=o}function ri(e,t,n,r,i,a,o,s,c,l){let u=o%2/2;De==1&&O.translate(u,u),Ur(s,o,c,l,s),O.beginPath();let d,f,p,m,h=i+(r==0||r==3?-a:a);n==0?(f=i,m=h):(d=i,p=h);for(let r=0;r<e.length;r++)t[r]!=null&&(n==0?d=p=e[r]:f=m=e[r],O.moveTo(d,f),O.lineTo(p,m));O.stroke(),De==1&&O.translate(-u,-u)}function ai(e){let t=!0;return Ne.forEach((n,i)=>{if(!n.show)return;let a=M[n.scale];if(a.min==null){n._show&&(t=!1,n._show=!1,Ci(!1));return}n._show||(t=!1,n._show=!0,Ci(!1));let o=n.side,s=o%2,{min:c,max:l}=a,[u,d]=ni(i,c,l,s==0?H:U);if(d==0)return;let f=a.distr==2,p=n._splits=n.splits(r,i,c,l,u,d,f),m=a.distr==2?p.map(e=>wr[e]):p,h=a.distr==2?wr[p[1]]-wr[p[0]]:u,g=n._values=n.values(r,n.filter(r,m,i,d,h),i,d,h);n._rotate=o==2?n.rotate(r,g,i,d):0;let _=n._size;n._size=tt(n.size(r,g,i,e)),_!=null&&n._size!=_&&(t=!1)}),t}function xi(e){let t=!0;return cr.forEach((n,i)=>{let a=n(r,i,Zn,e);a!=lr[i]&&(t=!1),lr[i]=a}),t}function Si(){for(let e=0;e<Ne.length;e++){let t=Ne[e];if(!t.show||!t._show)continue;let n=t.side,i=n%2,a,o,s=t.stroke(r,e),c=n==0||n==3?-1:1,[l,u]=t._found;if(t.label!=null){let d=t.labelGap*c,f=et((t._lpos+d)*k);Wr(t.labelFont[0],s,`center`,n==2?ne:re),O.save(),i==1?(a=o=0,O.translate(f,et(dn+pn/2)),O.rotate((n==3?-Qe:Qe)/2)):(a=et(un+fn/2),o=f);let p=ft(t.label)?t.label(r,e,l,u):t.label;O.fillText(p,a,o),O.restore()}if(u==0)continue;let d=M[t.scale],f=i==0?fn:pn,p=i==0?un:dn,m=t._splits,h=d.distr==2?m.map(e=>wr[e]):m,g=d.distr==2?wr[m[1]]-wr[m[0]]:l,_=t.ticks,v=t.border,y=_.show?_.size:0,b=et(y*k),x=et((t.alignTo==2?t._size-y-t.gap:t.gap)*k),S=t._rotate*-Qe/180,C=ke(t._pos*k),w=C+(b+x)*c;o=i==0?w:0,a=i==1?w:0;let T=t.font[0];Wr(T,s,t.align==1?ie:t.align==2?ae:S>0?ie:S<0?ae:i==0?`center`:n==3?ae:ie,S||i==1?`middle`:n==2?ne:re);let E=t.font[1]*t.lineGap,ee=m.map(e=>ke(oe(e,d,f,p))),te=t._values;for(let e=0;e<te.length;e++){let t=te[e];if(t!=null){i==0?a=ee[e]:o=ee[e],t=``+t;let n=t.indexOf(`
`)==-1?[t]:t.split(/\n/gm);for(let e=0;e<n.length;e++){let t=n[e];S?(O.save(),O.translate(a,o+e*E),O.rotate(S),O.fillText(t,0,0),O.restore()):O.fillText(t,a,o+e*E)}}}_.show&&ri(ee,_.filter(r,h,e,u,g),i,n,C,b,V(_.width*k,3),_.stroke(r,e),_.dash,_.cap);let se=t.grid;se.show&&ri(ee,se.filter(r,h,e,u,g),i,i==0?2:1,i==0?dn:un,i==0?pn:fn,V(se.width*k,3),se.stroke(r,e),se.dash,se.cap),v.show&&ri([C],[1],+(i==0),i==0?1:2,i==1?dn:un,i==1?pn:fn,V(v.width*k,3),v.stroke(r,e),v.dash,v.cap)}Q(`drawAxes`)}function Ci(e){j.forEach((t,n)=>{n>0&&(t._paths=null,e&&(i==1?(t.min=null,t.max=null):t.facets.forEach(e=>{e.min=null,e.max=null})))})}let wi=!1,Ti=!1,Ei=[];function Di(){Ti=!1;for(let e=0;e<Ei.length;e++)Q(...Ei[e]);Ei.length=0}function Oi(){wi||=(Ut(Ai),!0)}function ki(e,t=!1){wi=!0,Ti=t,e(r),Ai(),t&&Ei.length>0&&queueMicrotask(Di)}r.batch=ki;function Ai(){if(mn&&=(qr(),!1),gn&&=(Nn(),!1),hn){if(A(xe,ie,tn),A(xe,ne,nn),A(xe,ee,H),A(xe,te,U),A(Se,ie,tn),A(Se,ne,nn),A(Se,ee,H),A(Se,te,U),A(be,ee,Qt),A(be,te,$t),D.width=et(Qt*k),D.height=et($t*k),Ne.forEach(({_el:e,_show:t,_size:n,_pos:r,side:i})=>{if(e!=null){if(t){let t=i===3||i===0?n:0,a=i%2==1;A(e,a?`left`:`top`,r-t),A(e,a?`width`:`height`,n),A(e,a?`top`:`left`,a?nn:tn),A(e,a?`height`:`width`,a?U:H),we(e,h)}else Ce(e,h)}}),Mr=Nr=Pr=Lr=Rr=zr=Br=Vr=Ir=null,Hr=1,ma(!0),tn!=rn||nn!=an||H!=on||U!=ln){Ci(!1);let e=H/on,t=U/ln;if(wt&&!_n&&B.left>=0){B.left*=e,B.top*=t,Pi&&Oe(Pi,et(B.left),0,H,U),Fi&&Oe(Fi,0,et(B.top),H,U);for(let n=0;n<Un.length;n++){let r=Un[n];r!=null&&(Gn[n]*=e,Kn[n]*=t,Oe(r,tt(Gn[n]),tt(Kn[n]),H,U))}}if(q.show&&!vn&&q.left>=0&&q.width>0){q.left*=e,q.width*=e,q.top*=t,q.height*=t;for(let e in _a)A(Ki,e,q[e])}rn=tn,an=nn,on=H,ln=U}Q(`setSize`),hn=!1}Qt>0&&$t>0&&(O.clearRect(0,0,D.width,D.height),Q(`drawClear`),ze.forEach(e=>e()),Q(`draw`)),q.show&&vn&&(qi(q),vn=!1),wt&&_n&&(fa(null,!0,!1),_n=!1),z.show&&z.live&&W&&(ua(),W=!1),me||(me=!0,r.status=1,Q(`ready`)),Or=!1,wi=!1}r.redraw=(e,t)=>{gn=t||!1,e===!1?Oi():J(N,F.min,F.max)};function ji(e,n){let i=M[e];if(i.from==null){if(ur==0){let t=i.range(r,n.min,n.max,e);n.min=t[0],n.max=t[1]}if(n.min>n.max){let e=n.min;n.min=n.max,n.max=e}if(ur>1&&n.min!=null&&n.max!=null&&n.max-n.min<1e-16)return;e==N&&i.distr==2&&ur>0&&(n.min=Ie(n.min,t[0]),n.max=Ie(n.max,t[0]),n.min==n.max&&n.max++),I[e]=n,mn=!0,Oi()}}r.setScale=ji;let Mi,Ni,Pi,Fi,Ii,Li,Ri,zi,Bi,Vi,G,K,Hi=!1,Ui=B.drag,Wi=Ui.x,Gi=Ui.y;wt&&(B.x&&(Mi=Ee(_,Se)),B.y&&(Ni=Ee(v,Se)),F.ori==0?(Pi=Mi,Fi=Ni):(Pi=Ni,Fi=Mi),G=B.left,K=B.top);let q=r.select=Lt({show:!0,over:!0,left:0,width:0,top:0,height:0},e.select),Ki=q.show?Ee(g,q.over?Se:xe):null;function qi(e,t){if(q.show){for(let t in e)q[t]=e[t],t in _a&&A(Ki,t,e[t]);t!==!1&&Q(`setSelect`)}}r.setSelect=qi;function Ji(e){if(j[e].show)xt&&we(zt[e],h);else if(xt&&Ce(zt[e],h),wt){let t=Hn?Un[0]:Un[e];t!=null&&Oe(t,-10,-10,H,U)}}function J(e,t,n){ji(e,{min:t,max:n})}function Y(e,t,n,a){t.focus!=null&&ra(e),t.show!=null&&j.forEach((n,r)=>{r>0&&(e==r||e==null)&&(n.show=t.show,Ji(r),i==2?(J(n.facets[0].scale,null,null),J(n.facets[1].scale,null,null)):J(n.scale,null,null),Oi())}),n!==!1&&Q(`setSeries`,e,t),a&&Ma(`setSeries`,r,e,t)}r.setSeries=Y;function Yi(e,t){Lt(Le[e],t)}function Xi(e,t){e.fill=R(e.fill||null),e.dir=P(e.dir,-1),t??=Le.length,Le.splice(t,0,e)}function Zi(e){e==null?Le.length=0:Le.splice(e,1)}r.addBand=Xi,r.setBand=Yi,r.delBand=Zi;function Qi(e,t){j[e].alpha=t,wt&&Un[e]!=null&&(Un[e].style.opacity=t),xt&&zt[e]&&(zt[e].style.opacity=t)}let $i,ea,ta,na={focus:!0};function ra(e){if(e!=ta){let t=e==null,n=Bn.alpha!=1;j.forEach((r,a)=>{if(i==1||a>0){let i=t||a==0||a==e;r._focus=t?null:i,n&&Qi(a,i?1:Bn.alpha)}}),ta=e,n&&Oi()}}xt&&Vn&&Xt(fe,Pt,e=>{B._lock||(Rn(e),ta!=null&&Y(null,na,!0,$.setSeries))});function X(e,t,n){let r=M[t];n&&(e=e/k-(r.ori==1?nn:tn));let i=H;r.ori==1&&(i=U,e=i-e),r.dir==-1&&(e=i-e);let a=r._min,o=r._max,s=e/i,c=a+(o-a)*s,l=r.distr;return l==3?it(10,c):l==4?ct(c,r.asinh):l==100?r.bwd(c):c}function ia(e,n){return Ie(X(e,N,n),t[0],gr,_r)}r.valToIdx=e=>Ie(e,t[0]),r.posToIdx=ia,r.posToVal=X,r.valToPos=(e,t,n)=>M[t].ori==0?a(e,M[t],n?fn:H,n?un:0):o(e,M[t],n?pn:U,n?dn:0),r.setCursor=(e,t,n)=>{G=e.left,K=e.top,fa(null,t,n)};function aa(e,t){A(Ki,ie,q.left=e),A(Ki,ee,q.width=t)}function oa(e,t){A(Ki,ne,q.top=e),A(Ki,te,q.height=t)}let sa=F.ori==0?aa:oa,ca=F.ori==1?aa:oa;function la(){if(xt&&z.live)for(let e=+(i==2);e<j.length;e++){if(e==0&&Ht)continue;let t=z.values[e],n=0;for(let r in t)Bt[e][n++].firstChild.nodeValue=t[r]}}function ua(e,t){if(e!=null&&(e.idxs?e.idxs.forEach((e,t)=>{yt[t]=e}):At(e.idx)||yt.fill(e.idx),z.idx=yt[0]),xt&&z.live){for(let e=0;e<j.length;e++)(e>0||i==1&&!Ht)&&da(e,yt[e]);la()}W=!1,t!==!1&&Q(`setLegend`)}r.setLegend=ua;function da(e,n){let i=j[e],a=e==0&&Ye==2?wr:t[e],o;Ht?o=i.values(r,e,n)??Wt:(o=i.value(r,n==null?null:a[n],e,n),o=o==null?Wt:{_:o}),z.values[e]=o}function fa(e,n,a){Bi=G,Vi=K,[G,K]=B.move(r,G,K),B.left=G,B.top=K,wt&&(Pi&&Oe(Pi,et(G),0,H,U),Fi&&Oe(Fi,0,et(K),H,U));let o,s=gr>_r;$i=L,ea=null;let c=F.ori==0?H:U,l=F.ori==1?H:U;if(G<0||ur==0||s){o=B.idx=null;for(let e=0;e<j.length;e++){let t=Un[e];t!=null&&Oe(t,-10,-10,H,U)}Vn&&Y(null,na,!0,e==null&&$.setSeries),z.live&&(yt.fill(o),W=!0)}else{let e,n,a;i==1&&(e=F.ori==0?G:K,n=X(e,N),o=B.idx=Ie(n,t[0],gr,_r),a=Xe(t[0][o],F,c,0));let s=-10,u=-10,d=0,f=0,p=!0,m=``,h=``;for(let e=+(i==2);e<j.length;e++){let g=j[e],_=yt[e],v=_==null?null:i==1?t[e][_]:t[e][1][_],y=B.dataIdx(r,e,o,n),b=y==null?null:i==1?t[e][y]:t[e][1][y];if(W=W||b!=v||y!=_,yt[e]=y,e>0&&g.show){let n=y==null?-10:y==o?a:Xe(i==1?t[0][y]:t[e][0][y],F,c,0),_=b==null?-10:Ze(b,i==1?M[g.scale]:M[g.facets[1].scale],l,0);if(Vn&&b!=null){let t=F.ori==1?G:K,n=$e(Bn.dist(r,e,y,_,t));if(n<$i){let r=Bn.bias;if(r!=0){let i=X(t,g.scale),a=b>=0?1:-1,o=i>=0?1:-1;o==a&&(o==1?r==1?b>=i:b<=i:r==1?b<=i:b>=i)&&($i=n,ea=e)}else $i=n,ea=e}}if(W||Hn){let t,i;F.ori==0?(t=n,i=_):(t=_,i=n);let a,o,c,l,g,v,y=!0,b=zn.bbox;if(b!=null){y=!1;let t=b(r,e);c=t.left,l=t.top,a=t.width,o=t.height}else c=t,l=i,a=o=zn.size(r,e);if(v=zn.fill(r,e),g=zn.stroke(r,e),Hn)e==ea&&$i<=Bn.prox&&(s=c,u=l,d=a,f=o,p=y,m=v,h=g);else{let t=Un[e];t!=null&&(Gn[e]=c,Kn[e]=l,Me(t,a,o,y),Ae(t,v,g),Oe(t,tt(c),tt(l),H,U))}}}}if(Hn){let e=Bn.prox;if(W||(ta==null?$i<=e:$i>e||ea!=ta)){let e=Un[0];e!=null&&(Gn[0]=s,Kn[0]=u,Me(e,d,f,p),Ae(e,m,h),Oe(e,tt(s),tt(u),H,U))}}}if(q.show&&Hi){if(e!=null){let[t,n]=$.scales,[r,i]=$.match,[a,o]=e.cursor.sync.scales,s=e.cursor.drag;if(Wi=s._x,Gi=s._y,Wi||Gi){let{left:s,top:u,width:d,height:f}=e.select,p=e.scales[a].ori,m=e.posToVal,h,g,_,v,y,b=t!=null&&r(t,a),x=n!=null&&i(n,o);b&&Wi?(p==0?(h=s,g=d):(h=u,g=f),_=M[t],v=Xe(m(h,a),_,c,0),y=Xe(m(h+g,a),_,c,0),sa(nt(v,y),$e(y-v))):sa(0,c),x&&Gi?(p==1?(h=s,g=d):(h=u,g=f),_=M[n],v=Ze(m(h,o),_,l,0),y=Ze(m(h+g,o),_,l,0),ca(nt(v,y),$e(y-v))):ca(0,l)}else va()}else{let e=$e(Bi-Ii),t=$e(Vi-Li);if(F.ori==1){let n=e;e=t,t=n}Wi=Ui.x&&e>=Ui.dist,Gi=Ui.y&&t>=Ui.dist;let n=Ui.uni;n==null?Ui.x&&Ui.y&&(Wi||Gi)&&(Wi=Gi=!0):Wi&&Gi&&(Wi=e>=n,Gi=t>=n,!Wi&&!Gi&&(t>e?Gi=!0:Wi=!0));let r,i;Wi&&(F.ori==0?(r=Ri,i=G):(r=zi,i=K),sa(nt(r,i),$e(i-r)),Gi||ca(0,l)),Gi&&(F.ori==1?(r=Ri,i=G):(r=zi,i=K),ca(nt(r,i),$e(i-r)),Wi||sa(0,c)),!Wi&&!Gi&&(sa(0,0),ca(0,0))}}if(Ui._x=Wi,Ui._y=Gi,e==null){if(a){if(Aa!=null){let[e,t]=$.scales;$.values[0]=e==null?null:X(F.ori==0?G:K,e),$.values[1]=t==null?null:X(F.ori==1?G:K,t)}Ma(ce,r,G,K,H,U,o)}if(Vn){let e=a&&$.setSeries,t=Bn.prox;ta==null?$i<=t&&Y(ea,na,!0,e):$i>t?Y(null,na,!0,e):ea!=ta&&Y(ea,na,!0,e)}}W&&(z.idx=o,ua()),n!==!1&&Q(`setCursor`)}let pa=null;Object.defineProperty(r,"rect",{get(){return pa??ma(!1),pa}});function ma(e=!1){e?pa=null:(pa=Se.getBoundingClientRect(),Q(`syncRect`,pa))}function ha(e,t,n,r,i,a,o){B._lock||Hi&&e!=null&&e.movementX==0&&e.movementY==0||(ga(e,t,n,r,i,a,o,!1,e!=null),e==null?fa(t,!0,!1):fa(null,!0,!0))}function ga(e,t,n,i,a,o,s,c,l){if(pa??ma(!1),Rn(e),e!=null)n=e.clientX-pa.left,i=e.clientY-pa.top;else{if(n<0||i<0){G=-10,K=-10;return}let[e,r]=$.scales,s=t.cursor.sync,[c,l]=s.values,[u,d]=s.scales,[f,p]=$.match,m=t.axes[0].side%2==1,h=F.ori==0?H:U,g=F.ori==1?H:U,_=m?o:a,v=m?a:o,y=m?i:n,b=m?n:i;if(n=u==null?y/_*h:f(e,u)?oe(c,M[e],h,0):-10,i=d==null?b/v*g:p(r,d)?oe(l,M[r],g,0):-10,F.ori==1){let e=n;n=i,i=e}}l&&(t==null||t.cursor.event.type==ce)&&((n<=1||n>=H-1)&&(n=bt(n,H)),(i<=1||i>=U-1)&&(i=bt(i,U))),c?(Ii=n,Li=i,[Ri,zi]=B.move(r,n,i)):(G=n,K=i)}let _a={width:0,height:0,left:0,top:0};function va(){qi(_a,!1)}let ya,ba,Z,xa;function Sa(e,t,n,i,a,o,s){Hi=!0,Wi=Gi=Ui._x=Ui._y=!1,ga(e,t,n,i,a,o,s,!0,!1),e!=null&&(Xt(ue,ve,Ca,!1),Ma(le,r,Ri,zi,H,U,null));let{left:c,top:l,width:u,height:d}=q;ya=c,ba=l,Z=u,xa=d}function Ca(e,t,n,i,a,o,s){Hi=Ui._x=Ui._y=!1,ga(e,t,n,i,a,o,s,!1,!0);let{left:c,top:l,width:u,height:d}=q,f=u>0||d>0,p=ya!=c||ba!=l||Z!=u||xa!=d;if(f&&p&&qi(q),Ui.setScale&&f&&p){let e=c,t=u,n=l,r=d;if(F.ori==1&&(e=l,t=d,n=c,r=u),Wi&&J(N,X(e,N),X(e+t,N)),Gi)for(let e in M){let t=M[e];e!=N&&t.from==null&&t.min!=L&&J(e,X(n+r,e),X(n,e))}va()}else B.lock&&(B._lock=!B._lock,fa(t,!0,e!=null));e!=null&&(Zt(ue,ve),Ma(ue,r,G,K,H,U,null))}function wa(e,t,n,r,i,a,o){if(B._lock)return;Rn(e);let s=Hi;if(Hi){let e=!0,t=!0,n,r;F.ori==0?(n=Wi,r=Gi):(n=Gi,r=Wi),n&&r&&(e=G<=10||G>=H-10,t=K<=10||K>=U-10),n&&e&&(G=G<Ri?0:H),r&&t&&(K=K<zi?0:U),fa(null,!0,!0),Hi=!1}G=-10,K=-10,yt.fill(null),fa(null,!0,!0),s&&(Hi=s)}function Ta(e,t,n,i,a,o,s){B._lock||(Rn(e),jr(),va(),e!=null&&Ma(pe,r,G,K,H,U,null))}function Ea(){Ne.forEach(bi),yn(r.width,r.height,!0)}Pe(ge,ye,Ea);let Da={};Da.mousedown=Sa,Da.mousemove=ha,Da.mouseup=Ca,Da.dblclick=Ta,Da.setSeries=(e,t,n,i)=>{let a=$.match[2];n=a(r,t,n),n!=-1&&Y(n,i,!0,!1)},wt&&(Xt(le,Se,Sa),Xt(ce,Se,ha),Xt(de,Se,e=>{Rn(e),ma(!1)}),Xt(fe,Se,wa),Xt(pe,Se,Ta),ii.add(r),r.syncRect=ma);let Oa=r.hooks=e.hooks||{};function Q(e,t,n){Ti?Ei.push([e,t,n]):e in Oa&&Oa[e].forEach(e=>{e.call(null,r,t,n)})}(e.plugins||[]).forEach(e=>{for(let t in e.hooks)Oa[t]=(Oa[t]||[]).concat(e.hooks[t])});let ka=(e,t,n)=>n,$=Lt({key:null,setSeries:!1,filters:{pub:_t,sub:_t},scales:[N,j[1]?j[1].scale:null],match:[vt,vt,ka],values:[null,null]},B.sync);$.match.length==2&&$.match.push(ka),B.sync=$;let Aa=$.key,ja=Tr(Aa);function Ma(e,t,n,r,i,a,o){$.filters.pub(e,t,n,r,i,a,o)&&ja.pub(e,t,n,r,i,a,o)}ja.sub(r);function Na(e,t,n,r,i,a,o){$.filters.sub(e,t,n,r,i,a,o)&&Da[e](null,t,n,r,i,a,o)}r.pub=Na;function Pa(){ja.unsub(r),ii.delete(r),Yt.clear(),Fe(ge,ye,Ea),he.remove(),Pt?.remove(),Q(`destroy`)}r.destroy=Pa;function Fa(){Q(`init`,e,t),kr(t||e.data,!1),I[N]?ji(N,I[N]):jr(),vn=q.show&&(q.width>0||q.height>0),_n=W=!0,yn(e.width,e.height)}return j.forEach(Jn),Ne.forEach(or),n?n instanceof HTMLElement?(n.appendChild(he),Fa()):n(r,Fa):Fa(),r}xi.assign=Lt,xi.fmtNum=Xe,xi.rangeNum=qe,xi.rangeLog=Ve,xi.rangeAsinh=He,xi.orient=Or,xi.pxRatio=k,xi.join=Ht,xi.fmtDate=en,xi.tzDate=tn,xi.sync=Tr;{xi.addGap=Nr,xi.clipGaps=Mr;let e=xi.paths={points:qr};e.linear=Zr,e.stepped=Qr,e.bars=ei,e.spline=ni}var Si=25.4,Ci=`mm`,wi=e=>{Ci=e},Ti=()=>Ci,Ei=()=>Ci===`mm`?`µm`:`thou`,Di=e=>Ci===`mm`?e:e/Si;function Oi(e){let t=Number(e);return e===`-`||!Number.isFinite(t)?`–`:Ci===`in`?(t/Si).toFixed(3):typeof e==`string`?e:e.toFixed(2)}function ki(e){let t=(Ci===`mm`?e:e/Si).toFixed(Ci===`mm`?3:4);return Number(t)===0?t.replace(`-`,``):t.replace(`-`,`−`)}var Ai=e=>`${Number((Ci===`mm`?e:e/Si).toPrecision(3))} ${Ci}`,ji=2400,Mi=class{onPick=()=>{};#e;#t=[];#n;constructor(e){this.#n=e,new ResizeObserver(()=>this.#e?.setSize({width:e.clientWidth,height:e.clientHeight})).observe(e)}show(e){if(this.#t=e,this.#e?.destroy(),this.#e=void 0,!e.length)return;let n={stroke:t(`--grid`),width:1},r={stroke:t(`--ink-3`),grid:n,ticks:n,font:`12px system-ui, sans-serif`},i={width:this.#n.clientWidth,height:this.#n.clientHeight,legend:{show:!1},scales:{x:{time:!1}},cursor:{drag:{x:!0,y:!1,setScale:!1},points:{show:!1}},axes:[{...r,size:28,values:(e,t)=>t.map((e,n)=>n===t.length-1?`${e} s`:`${e}`)},{...r,size:52,label:Ei(),labelSize:16,labelFont:`12px system-ui, sans-serif`}],series:[{},...e.map((e,n)=>({label:e.figures.name,stroke:t(`--run-${n}`),width:1,points:{show:!1}}))],hooks:{setSelect:[e=>{let{left:t,width:n}=e.select;n>4&&this.#i(e.posToVal(t,`x`),e.posToVal(t+n,`x`)),e.setSelect({left:0,top:0,width:0,height:0},!1)}]}};this.#e=new xi(i,this.#a(0,this.#r()),this.#n),this.#e.over.addEventListener(`click`,()=>{let e=this.#e.cursor.left??-1;e>=0&&this.onPick(this.#e.posToVal(e,`x`))}),this.#e.over.addEventListener(`dblclick`,()=>this.#i(0,this.#r()))}tool(e){let t=this.#e;t?.setCursor({left:t.valToPos(e,`x`),top:t.over.clientHeight/2},!1)}#r(){return Math.max(...this.#t.map(({t_s:e})=>e[e.length-1]??0))}#i(e,t){this.#e.setData(this.#a(e,t),!1),this.#e.batch(()=>{this.#e.setScale(`x`,{min:e,max:t})})}#a(e,t){let n=(t-e)/ji||1,r=Array.from({length:2401},(t,r)=>e+r*n);return[r,...this.#t.map(({t_s:t,error_um:i,cutting:a})=>{let o=r.map(()=>null),s=(e,t)=>{Math.abs(t)>Math.abs(o[e]??0)&&(o[e]=t)};for(let r=0;r<t.length;r++){let o=Math.round((t[r]-e)/n);if(!a[r]||o<0||o>ji)continue;let c=Di(i[r]);if(s(o,c),!a[r+1])continue;let l=Math.min(ji,Math.round((t[r+1]-e)/n));for(let e=o+1;e<l;e++)s(e,c+(Di(i[r+1])-c)*(e-o)/(l-o))}return o})]}},Ni=class{onChange=()=>{};#e;#t;#n=new Map;#r=0;#i=1;constructor(e,t){[this.#e,this.#t]=[e,t],e.addEventListener(`input`,()=>{this.#s(),this.onChange()}),e.addEventListener(`scroll`,()=>this.#c()),new ResizeObserver(()=>this.#c()).observe(e)}get value(){return this.#e.value}set value(e){this.#e.value=e,this.#e.scrollTop=this.#r=0,this.#n.clear(),this.#s()}mark(e){this.#n=new Map([...e].reverse().map(({line:e,severity:t})=>[e,t])),this.#c()}current(e){e!==this.#r&&(this.#r=e,this.#o(e),this.#c())}go({line:e,column:t,length:n}){let r=this.value.split(`
`).slice(0,e-1).reduce((e,t)=>e+t.length+1,0)+Math.max(0,t-1);this.#e.focus(),this.#e.setSelectionRange(r,r+n),this.#o(e)}get#a(){return parseFloat(getComputedStyle(this.#e).lineHeight)}#o(e){let t=this.#a,n=(e-1)*t,{scrollTop:r,clientHeight:i}=this.#e;(n<r||n>r+i-2*t)&&(this.#e.scrollTop=n-i/2)}#s(){let e=this.value;this.#i=1;for(let t=-1;(t=e.indexOf(`
`,t+1))>=0;)this.#i++;this.#c()}#c(){let e=this.#a,{scrollTop:t,clientHeight:n}=this.#e,r=Math.floor(t/e)+1,i=Math.min(this.#i,r+Math.ceil(n/e)),a=[];for(let e=r;e<=i;e++){let t=document.createElement(`div`),n=this.#n.get(e);t.textContent=String(e),n&&t.classList.add(n),e===this.#r&&t.classList.add(`current`),a.push(t)}this.#t.replaceChildren(...a),this.#t.style.setProperty(`--shift`,`${(r-1)*e-t}px`)}},Pi;function Fi(){return Pi??=Ii(`engine.wasm.gz`).then(e=>WebAssembly.compile(e)),Pi}async function Ii(e){let t=await fetch(e);if(!t.ok)throw Error(`${e} is missing: ${t.status}`);let n=await t.arrayBuffer(),r=new Uint8Array(n,0,2);return r[0]!==31||r[1]!==139?n:new Response(new Blob([n]).stream().pipeThrough(new DecompressionStream(`gzip`))).arrayBuffer()}var Li=class extends Error{},Ri=class{#e;#t=new Map;#n=0;async ask(e,t={}){let n=await Fi(),r=this.#e??=this.#r(),i=++this.#n;return new Promise((a,o)=>{this.#t.set(i,{resolve:a,reject:o,listener:t}),r.postMessage({id:i,module:n,request:e})})}cancel(){this.#e?.terminate(),this.#e=void 0;let e=[...this.#t.values()];this.#t.clear(),e.forEach(e=>e.reject(new Li(`cancelled`)))}#r(){let e=new Worker(new URL(new URL(`engine.js`,import.meta.url).href,``+import.meta.url),{type:`module`,name:`engine`});return e.onmessage=({data:e})=>{let t=this.#t.get(e.id);t&&(e.kind===`progress`?t.listener.progress?.(e.stage,e.part):e.kind===`points`?t.listener.points?.(e.points):(this.#t.delete(e.id),e.kind===`done`?t.resolve(e.answer):t.reject(Error(e.reason))))},e.onerror=e=>{this.#t.forEach(t=>t.reject(Error(e.message||`the engine does not start`))),this.#t.clear()},e}},zi={star:{about:`Rounded star, 220 arcs`,program:`(Rounded five-pointed star: 12 + 4 cos 5a times cos a, sin a, a from 0 to 360 degrees, mm)
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
`}},Bi=class{play;slider;speed;onMove=()=>{};#e;#t=0;#n;constructor(e,t,n){this.play=e,this.slider=t,this.speed=n,e.addEventListener(`click`,()=>this.#n?this.stop():this.#r()),t.addEventListener(`input`,()=>{this.stop(),this.time(Number(t.value))}),n.addEventListener(`change`,()=>this.#n&&this.#r())}show(e){this.stop(),this.#e=e,this.#t=0;let t=e?e.t_s[e.t_s.length-1]:0;[this.slider.max,this.slider.step,this.slider.value]=[String(t),String(t/2e3||1),`0`],this.play.disabled=this.slider.disabled=this.speed.disabled=!e}time(e){let t=this.#e?.t_s;if(!t)return;let[n,r]=[0,t.length-1];for(;n<r;){let i=n+r>>1;t[i]<e?n=i+1:r=i}this.index(n>0&&e-t[n-1]<t[n]-e?n-1:n)}index(e){this.#e&&(this.#t=e,this.slider.value=String(this.#e.t_s[e]),this.onMove(e))}stop(){this.#n=void 0,this.play.textContent=`Play`}#r(){let e=this.#e?.t_s;if(!e)return;let t=this.#t>=e.length-1?0:e[this.#t],n={at:performance.now(),t_s:t};this.#n=n,this.play.textContent=`Pause`;let r=()=>{if(this.#n!==n)return;let i=t+(performance.now()-n.at)/1e3*Number(this.speed.value);this.time(i),i>=e[e.length-1]?this.stop():requestAnimationFrame(r)};requestAnimationFrame(r)}};function Vi(e,t,n){let r=e.length/3,i=new Int16Array(r).fill(-1),a=new Uint32Array(t+1);for(let e=1;e<r;e++)i[e]=n(e),i[e]>=0&&a[i[e]+1]++;for(let e=0;e<t;e++)a[e+1]+=a[e];let o=new Uint32Array(a[t]),s=a.slice();for(let e=1;e<r;e++)i[e]>=0&&(o[s[i[e]]++]=e);return{count:r,points:e,ends:o,starts:a}}var G=.7,K=32;function Hi(e,{ends:t,starts:n},r,{at:i,width:a,height:o,oneOf:s}){let c=-1,l=0,u=0;for(let d=n[r];d<n[r+1];d++){let f=t[d];if(s>1&&Math.floor(f/K)%s)continue;let p=i[2*f],m=i[2*f+1],h=i[2*f-2],g=i[2*f-1];p<0&&h<0||m<0&&g<0||p>a&&h>a||m>o&&g>o||(c!==f-1&&(e.moveTo(h,g),l=h,u=g),c=f,d+1<n[r+1]&&t[d+1]===f+1&&Math.abs(p-l)+Math.abs(m-u)<G||(e.lineTo(p,m),l=p,u=m))}}var Ui={top:[[1,0,0],[0,1,0]],front:[[1,0,0],[0,0,1]],right:[[0,1,0],[0,0,1]],iso:[[Math.SQRT1_2,Math.SQRT1_2,0],[-.408248,.408248,.816497]]},[Wi,Gi]=[50,20],q=256,Ki=200,qi=class{gain=0;onPick=()=>{};#e;#t;#n=`top`;#r={x:0,y:0,scale:1};#i=!0;#a;#o;#s;#c=1;#l=[];#u;#d=new Float32Array;#f=0;#p=1;#m=-1/0;#h=0;#g;constructor(e){[this.#e,this.#t]=[0,1].map(()=>e.appendChild(document.createElement(`canvas`))),this.#t.tabIndex=0,this.#t.setAttribute(`role`,`img`),new ResizeObserver(()=>this.#T()).observe(e),this.#D()}get shownGain(){return this.#o?this.gain||this.#v():1}get largest_um(){return this.#c}describe(e){this.#t.setAttribute(`aria-label`,e)}program({points:e,kinds:t}){this.#a=Vi(e,2,e=>t[e]&1),this.#g=Ji(e),this.#i&&this.fit(),this.redraw()}cut(e,t){this.#o=e,this.#c=t||1,this.#l=[],this.#u=void 0,this.regain()}add(e){this.#l.push(e);let t=e.length-4;t>=0&&(this.#u=[e[t],e[t+1],e[t+2]]),this.redraw()}side(e){this.#n=e,this.fit()}fit(){if(this.#i=!0,!this.#g)return;let e=[0,1,2,3,4,5,6,7].map(e=>this.#S([0,1,2].map(t=>this.#g[e>>t&1][t]))),[t,n]=[e.map(([e])=>e),e.map(([,e])=>e)],[r,i,a,o]=[Math.min(...t),Math.max(...t),Math.min(...n),Math.max(...n)],{clientWidth:s,clientHeight:c}=this.#e,l=e=>Math.max(1,e-56),u=Math.min(l(s)/Math.max(i-r,1e-6),l(c)/Math.max(o-a,1e-6));this.#r={x:(r+i)/2,y:(a+o)/2,scale:Math.min(u,1e5)},this.redraw()}zoomTo(e){if(!this.#g)return;let[t,n]=this.#g,r=Math.hypot(n[0]-t[0],n[1]-t[1],n[2]-t[2]),[i,a]=this.#S(e);this.#i=!1,this.#r={x:i,y:a,scale:Math.min(this.#e.clientWidth,this.#e.clientHeight)/Math.max(.1*r,.001)},this.redraw()}tool(e){let t=this.#o,n=this.#s?.points;this.#u=t&&n&&e!==void 0?[0,1,2].map(t=>n[3*e+t]):void 0,this.#b()}redraw(){this.#f||=requestAnimationFrame(()=>{this.#f=0,this.draw()})}#_(){this.#i=!1,clearTimeout(this.#h),this.#h=setTimeout(()=>{this.#m=-1/0,this.redraw()},Ki),this.#f||=requestAnimationFrame(e=>{this.#f=0;let t=e-this.#m;this.#m=e,t<1e3&&t>Wi?this.#p=Math.min(q,2*this.#p):t<Gi&&(this.#p=Math.max(1,this.#p/2)),this.draw(this.#p)})}draw(e=1){let n=this.#e.getContext(`2d`),r=devicePixelRatio,{clientWidth:i,clientHeight:o}=this.#e;n.setTransform(r,0,0,r,0,0),n.clearRect(0,0,i,o),n.lineJoin=`round`,this.#x(n,i,o);let s=(t,r,a)=>{n.beginPath(),Hi(n,t,r,{at:a,width:i,height:o,oneOf:e}),n.stroke()};if(this.#a){let e=this.#w(this.#a.points);[n.lineWidth,n.strokeStyle]=[1,t(`--rapid`)],n.setLineDash([3,4]),s(this.#a,0,e),n.setLineDash([]),[n.lineWidth,n.strokeStyle]=[1,t(`--path`)],s(this.#a,1,e)}if(this.#s){let e=this.#w(this.#s.points);n.lineWidth=this.#s.ends.length>3e4?1:1.8;for(let t=0;t<24;t++)n.strokeStyle=a((t+.5)/24),s(this.#s,t,e)}this.#y(n),this.#b()}regain(){let e=this.#o;if(e){let t=this.shownGain,n=e.foot_mm.map((n,r)=>n+t*e.deviation_mm[r]),r=t=>e.cutting[t]?Math.min(23,Math.floor(24*Math.abs(e.error_um[t])/this.#c)):-1;this.#s=Vi(n,24,r)}else this.#s=void 0;this.redraw()}#v(){if(!this.#g)return 1;let[e,t]=this.#g,n=.02*Math.hypot(t[0]-e[0],t[1]-e[1])/(.001*this.#c),r=10**Math.floor(Math.log10(n));return Math.max(1,r*([5,2,1].find(e=>e*r<=n)??1))}#y(e){if(!this.#l.length)return;e.lineWidth=1.8,e.strokeStyle=t(`--run-1`),e.beginPath();let n=!1;for(let t of this.#l)for(let r=0;r<t.length;r+=4){let[i,a]=this.#C([t[r],t[r+1],t[r+2]]);Number.isNaN(t[r+3])?n=!1:n?e.lineTo(i,a):(e.moveTo(i,a),n=!0)}e.stroke()}#b(){let e=this.#t.getContext(`2d`),n=devicePixelRatio;if(e.setTransform(n,0,0,n,0,0),e.clearRect(0,0,this.#t.clientWidth,this.#t.clientHeight),!this.#u)return;let[r,i]=this.#C(this.#u);e.fillStyle=t(`--panel`),e.strokeStyle=t(`--ink`),e.lineWidth=2,e.beginPath(),e.arc(r,i,5,0,2*Math.PI),e.fill(),e.stroke()}#x(e,n,r){let{x:i,y:a,scale:o}=this.#r,s=64/o,c=10**Math.floor(Math.log10(s)),l=c*([2,5,10].find(e=>e*c>=s)??10);e.strokeStyle=t(`--grid`),e.lineWidth=1,e.beginPath();for(let t=Math.ceil((i-n/2/o)/l);t*l<i+n/2/o;t++){let a=Math.round(n/2+(t*l-i)*o)+.5;e.moveTo(a,0),e.lineTo(a,r)}for(let t=Math.ceil((a-r/2/o)/l);t*l<a+r/2/o;t++){let i=Math.round(r/2-(t*l-a)*o)+.5;e.moveTo(0,i),e.lineTo(n,i)}e.stroke(),this.onGrid(l,this.#n)}onGrid=()=>{};#S([e,t,n]){let[r,i]=Ui[this.#n];return[r[0]*e+r[1]*t+r[2]*n,i[0]*e+i[1]*t+i[2]*n]}#C(e){let[t,n]=this.#S(e),{x:r,y:i,scale:a}=this.#r;return[this.#e.clientWidth/2+(t-r)*a,this.#e.clientHeight/2-(n-i)*a]}#w(e){let t=e.length/3,[n,r]=Ui[this.#n],{x:i,y:a,scale:o}=this.#r;this.#d.length<2*t&&(this.#d=new Float32Array(2*t));let s=this.#d,[c,l]=[this.#e.clientWidth/2-i*o,this.#e.clientHeight/2+a*o];for(let i=0;i<t;i++){let t=e[3*i],a=e[3*i+1],u=e[3*i+2];s[2*i]=c+o*(n[0]*t+n[1]*a+n[2]*u),s[2*i+1]=l-o*(r[0]*t+r[1]*a+r[2]*u)}return s}#T(){for(let e of[this.#e,this.#t])e.width=Math.round(e.clientWidth*devicePixelRatio),e.height=Math.round(e.clientHeight*devicePixelRatio);this.#i&&this.fit(),this.draw()}pan(e,t){this.#r.x-=e/this.#r.scale,this.#r.y+=t/this.#r.scale,this.#_()}zoom(e,t=this.#e.clientWidth/2,n=this.#e.clientHeight/2){let r=this.#r,[i,a]=[t-this.#e.clientWidth/2,this.#e.clientHeight/2-n],o=Math.min(1e6,Math.max(1e-4,r.scale*e));r.x+=i/r.scale-i/o,r.y+=a/r.scale-a/o,r.scale=o,this.#_()}#E(e,t){if(!this.#s)return;let n=this.#w(this.#s.points),[r,i]=[void 0,576];for(let a=0;a<this.#s.count;a++){let o=(n[2*a]-e)**2+(n[2*a+1]-t)**2;o<i&&([r,i]=[a,o])}return r}#D(){let e=this.#t,t=new Map,n=0;e.addEventListener(`wheel`,e=>{e.preventDefault(),this.zoom(Math.exp(-.0015*e.deltaY*(e.deltaMode===1?16:1)),e.offsetX,e.offsetY)},{passive:!1}),e.addEventListener(`pointerdown`,r=>{e.setPointerCapture(r.pointerId),t.set(r.pointerId,{x:r.offsetX,y:r.offsetY}),t.size===1&&(n=0)}),e.addEventListener(`pointermove`,e=>{let r=t.get(e.pointerId);if(!r)return;let i={x:e.offsetX,y:e.offsetY},a=[...t].find(([t])=>t!==e.pointerId)?.[1];if(a){let e=e=>Math.hypot(e.x-a.x,e.y-a.y);this.zoom(e(i)/Math.max(1,e(r)),(i.x+a.x)/2,(i.y+a.y)/2)}let o=a?.5:1;this.pan(o*(i.x-r.x),o*(i.y-r.y)),n+=Math.abs(i.x-r.x)+Math.abs(i.y-r.y),t.set(e.pointerId,i)});let r=e=>{if(t.delete(e.pointerId)&&e.type===`pointerup`&&n<4){let t=this.#E(e.offsetX,e.offsetY);t!==void 0&&this.onPick(t)}};e.addEventListener(`pointerup`,r),e.addEventListener(`pointercancel`,r),e.addEventListener(`dblclick`,()=>this.fit());let i={ArrowLeft:()=>this.pan(40,0),ArrowRight:()=>this.pan(-40,0),ArrowUp:()=>this.pan(0,40),ArrowDown:()=>this.pan(0,-40),"+":()=>this.zoom(1.25),"=":()=>this.zoom(1.25),"-":()=>this.zoom(.8),0:()=>this.fit()};e.addEventListener(`keydown`,e=>{let t=!e.ctrlKey&&!e.metaKey&&i[e.key];t&&(e.preventDefault(),t())})}};function Ji(e){if(!e.length)return;let[t,n]=[[1/0,1/0,1/0],[-1/0,-1/0,-1/0]];for(let r=0;r<e.length;r++)t[r%3]=Math.min(t[r%3],e[r]),n[r%3]=Math.max(n[r%3],e[r]);return[t,n]}var J=e=>document.getElementById(e),Y=new qi(J(`view`)),Yi=new Mi(J(`curve`)),Xi=new Ni(J(`text`),J(`gutter`)),Zi=new Bi(J(`play`),J(`time`),J(`speed`)),[Qi,$i]=[new Ri,new Ri],ea=J(`machine`),ta=J(`controller`),na=J(`example`),ra=J(`control`),X={name:`program.ngc`,lists:void 0,machineFile:void 0,checked:void 0,answer:void 0,corrected:void 0,shown:0},ia=`file`;function aa(){let e=ea.value===ia&&X.machineFile;return{name:X.name,program:Xi.value,machine:e?`${X.machineFile.text}\n`:ea.value,machine_name:e?X.machineFile.name:void 0}}var oa=()=>new Date().toISOString().slice(0,10);function sa(e,t,n=``){return X.name=e,Xi.value=t,na.value=n,J(`name`).textContent=e,document.title=`${e} · feedwright`,J(`welcome`).hidden=!0,Y.fit(),da(),Ma(),pa()}async function ca(e){await sa(`${e}.ngc`,zi[e].program,e),await ha()}async function la(e){for(let t of e){let e=await t.text();/\.toml$/i.test(t.name)?ua(t.name,e):await sa(t.name,e)}}function ua(e,t){X.machineFile={name:e,text:t},ea.querySelector(`[value=${ia}]`)?.remove(),ea.prepend(new Option(e,ia)),ea.value=ia,da(),pa()}function da(){$i.cancel(),[X.answer,X.corrected,X.shown]=[void 0,void 0,0],ba(``),wa(),Q()}var fa=0;async function pa(){let e=++fa;if(Qi.cancel(),!Xi.value.trim())X.checked=void 0,xa();else try{let t=await Qi.ask({...aa(),task:`check`});if(e!==fa)return;X.checked=t,xa()}catch(t){!(t instanceof Li)&&e===fa&&ba(String(t.message))}}async function ma(e){$i.cancel(),ba(``);let t=performance.now(),n=``,r=(e,r)=>{e!==n&&([n,t]=[e,performance.now()]);let i=(performance.now()-t)/1e3*(1/r-1);J(`stage`).textContent=e,J(`bar`).value=r,J(`left`).textContent=r>.05&&r<1&&i>=1?`${Math.ceil(i)} s left in this step`:``};va(!0),r(`starting`,0);try{await e(r)}catch(e){if(e instanceof Li)return;ba(String(e.message))}va(!1)}async function ha(){J(`run`).disabled||(await ma(async e=>{Y.cut(void 0,1);let t={...aa(),task:`run`,controller:ta.value,recorded_on:oa(),page:!0};X.answer=await $i.ask(t,{progress:e,points:e=>Y.add(e)}),wa()}),X.answer||Y.cut(void 0,1))}async function ga(){await ma(async e=>{X.corrected=await $i.ask({...aa(),task:`correct`,target:ra.value},{progress:e}),Q()})}function _a(){$i.cancel(),va(!1),X.answer||Y.cut(void 0,1)}function va(e){J(`work`).hidden=!e,document.body.classList.toggle(`busy`,e),ya()}function ya(){let e=!!X.lists&&!!X.checked?.amounts&&J(`work`).hidden;for(let t of[`run`,`correct`])J(t).disabled=!e}function ba(e){J(`message`).textContent=e,J(`message`).hidden=!e}function Z(e,t=``,n=``){let r=document.createElement(e);return[r.textContent,r.className]=[t,n],r}function xa(){let{checked:e}=X,t=e?.findings??[];e&&Y.program(e),Xi.mark(t),J(`findings`).replaceChildren(...t.slice(0,200).map(Sa));let n=e?.amounts,r=t.filter(({severity:e})=>e===`error`).length;J(`amounts`).textContent=n?`${n.lines} lines, ${n.motions} motions, ${Ai(n.feed_mm)} of cuts, ${Ai(n.rapid_mm)} of rapids. Read as ${n.dialect}.`:r?`${r} mistake${r===1?``:`s`}: nothing can be cut.`:``,ya()}function Sa(e){let t=Z(`li`,``,e.severity),n=Z(`button`);return n.type=`button`,n.append(Z(`b`,`${e.line}:${e.column} ${e.severity}`),` ${e.message}`),e.hint&&n.append(Z(`small`,`hint: ${e.hint}`)),n.addEventListener(`click`,()=>Xi.go(e)),t.append(n),t}var Ca=e=>Math.max(...e.map(({figures:e})=>Number(e.max_um)).filter(Number.isFinite),0);function wa(){let{answer:e}=X,t=e?.cuts??[];for(let t of[`figures`,`report`,`worst-title`,`legend`])J(t).hidden=!e;J(`verdict`).textContent=e?.verdict.split(` Cost:`)[0]??`Run shows what the machine will cut without a correction and with the controller.`,Ta(J(`figures`),t.map(({figures:e})=>e),!0),J(`shown`).replaceChildren(...t.map(({figures:e},t)=>{let n=Z(`button`,e.name);return n.type=`button`,n.addEventListener(`click`,()=>Ea(t)),n})),Yi.show(t),J(`key`).replaceChildren(Z(`b`,`Contour error over time`),...t.map(({figures:e},t)=>Z(`span`,e.name,`run run-${t}`))),Ea(Math.min(X.shown,Math.max(0,t.length-1)))}function Ta(e,t,n=!1){e.querySelectorAll(`.unit`).forEach(e=>e.textContent=Ei()),e.querySelector(`tbody`).replaceChildren(...t.map((e,t)=>{let r=Z(`tr`),i=Z(`th`,e.name,n?`run run-${t}`:``);return i.scope=`row`,r.append(i,...[e.time_s,Oi(e.rms_um),Oi(e.max_um)].map(e=>Z(`td`,e))),r}))}function Ea(e){X.shown=e;let t=X.answer?.cuts??[],n=t[e];[...J(`shown`).children].forEach((t,n)=>t.setAttribute(`aria-pressed`,String(n===e))),Y.cut(n,Ca(t)),Zi.show(n),J(`readout`).textContent=``,J(`largest`).textContent=`${Oi(Ca(t))} ${Ei()}`,J(`worst`).replaceChildren(...(n?.worst??[]).map(e=>Da(e))),Oa(),Y.describe(n?`Path of ${X.name}, ${n.figures.name}: largest contour error ${Oi(n.figures.max_um)} ${Ei()}. Arrow keys move, + and − zoom, 0 fits.`:`Path of ${X.name}`)}function Da(e){let t=Z(`li`),n=Z(`button`);return n.type=`button`,n.append(Z(`b`,`${Oi(Math.abs(e.error_um))} ${Ei()}`),Z(`span`,`line ${e.line}`),Z(`code`,e.text)),n.addEventListener(`click`,()=>{Y.zoomTo(e.position_mm),Zi.time(e.t_s),t.parentElement.querySelectorAll(`[aria-current]`).forEach(e=>e.removeAttribute(`aria-current`)),n.setAttribute(`aria-current`,`true`)}),t.append(n),t}function Oa(){let e=Y.shownGain;J(`gain-now`).textContent=e>1?`errors drawn ${e} times too large`:``}function Q(){let{corrected:e}=X;if(J(`corrected`).hidden=!e,!e)return;Ta(J(`corrected`),e.figures);let{refusal:t,hint:n,stretches:r,stretches_changed:i,rounds:a}=e;J(`correction`).textContent=t?`No corrected program: ${t}.${n?` Hint: ${n}.`:``}`:`${i} of ${r} stretches between corners were changed, found in ${a} simulated cuts. Both cut without feedback, as the control plans them.`;for(let n of[`download`,`take`])J(n).hidden=!e.program||!!t}function ka(e){let t=X.answer?.cuts[X.shown];if(!t)return;Y.tool(e),Yi.tool(t.t_s[e]),Xi.current(t.line[e]);let n=[0,1,2].map(n=>ki(t.foot_mm[3*e+n]+t.deviation_mm[3*e+n])),r=t.cutting[e]?`error ${Oi(Math.abs(t.error_um[e]))} ${Ei()}`:`rapid or rest`;J(`readout`).textContent=`${t.t_s[e].toFixed(3)} s   line ${t.line[e]}   X ${n[0]}  Y ${n[1]}  Z ${n[2]} ${Ti()}   ${r}`}function $(){let e=J(`colors`),t=e.getContext(`2d`);for(let n=0;n<e.width;n++)t.fillStyle=a(n/e.width),t.fillRect(n,0,1,e.height)}function Aa(e,t){let n=Z(`a`);n.href=URL.createObjectURL(t),n.download=e,n.click(),setTimeout(()=>URL.revokeObjectURL(n.href),6e4)}var ja=()=>X.name.replace(/\.[^.]*$/,``);function Ma(){let{lists:e}=X;if(!e)return;let t=new URLSearchParams;na.value&&t.set(`example`,na.value),ea.value!==ia&&ea.value!==e.machine&&t.set(`machine`,ea.value),ta.value!==e.controller&&t.set(`controller`,ta.value),ra.value!==e.control&&t.set(`control`,ra.value),Ti()!==`mm`&&t.set(`units`,Ti()),history.replaceState(null,``,t.size?`#${t}`:location.pathname)}function Na(){let e=new URLSearchParams(location.hash.slice(1)),t=(t,n)=>{let r=e.get(n);r&&[...t.options].some(e=>e.value===r)&&(t.value=r)};t(ea,`machine`),t(ta,`controller`),t(ra,`control`),e.get(`units`)===`in`&&Pa(`in`);let n=e.get(`example`)??``;return Object.hasOwn(zi,n)?n:``}function Pa(e){wi(e),Fa(`[data-units]`,t=>t.dataset.units===e)}function Fa(e,t){document.querySelectorAll(e).forEach(e=>e.setAttribute(`aria-pressed`,String(t(e))))}function Ia(){J(`open`).addEventListener(`click`,()=>J(`file`).click()),J(`file`).addEventListener(`change`,e=>{let t=e.target;la([...t.files??[]]).then(()=>t.value=``)}),na.addEventListener(`change`,()=>na.value&&ca(na.value));let e=0;Xi.onChange=()=>{na.value=``,J(`welcome`).hidden=!0,clearTimeout(e),e=setTimeout(()=>{da(),Ma(),pa()},200)};for(let e of[ea,ta])e.addEventListener(`change`,()=>{da(),Ma(),pa()});ra.addEventListener(`change`,()=>{X.corrected=void 0,Q(),Ma()}),J(`run`).addEventListener(`click`,ha),J(`correct`).addEventListener(`click`,ga),J(`cancel`).addEventListener(`click`,_a),document.addEventListener(`keydown`,e=>{e.key===`Enter`&&(e.ctrlKey||e.metaKey)?ha():e.key===`Escape`&&!J(`work`).hidden&&_a()}),La(),Ra(),za()}function La(){J(`report`).addEventListener(`click`,()=>X.answer&&Aa(`${ja()}.report.html`,X.answer.report));let e=()=>new Blob([X.corrected.program],{type:`text/plain`});J(`download`).addEventListener(`click`,()=>X.corrected&&Aa(`${ja()}.corrected.ngc`,e())),J(`take`).addEventListener(`click`,()=>X.corrected&&sa(`${ja()}.corrected.ngc`,X.corrected.program))}function Ra(){document.querySelectorAll(`[data-units]`).forEach(e=>e.addEventListener(`click`,()=>{Pa(e.dataset.units),Ma(),xa(),wa(),Q()})),document.querySelectorAll(`[data-side]`).forEach(e=>e.addEventListener(`click`,()=>{Y.side(e.dataset.side),Fa(`[data-side]`,t=>t===e)})),J(`fit`).addEventListener(`click`,()=>Y.fit()),J(`gain`).addEventListener(`change`,e=>{Y.gain=Number(e.target.value),Y.regain(),Oa()}),Y.onGrid=(e,t)=>{let n={top:`X right, Y up`,front:`X right, Z up`,right:`Y right, Z up`,iso:`from the front left, above`}[t];J(`scale`).textContent=X.checked?`grid ${Ai(e)} · ${n}`:``},Y.onPick=e=>{Zi.stop(),Zi.index(e)},Yi.onPick=e=>{Zi.stop(),Zi.time(e)},Zi.onMove=ka,matchMedia(`(prefers-color-scheme: dark)`).addEventListener(`change`,()=>{$(),Y.redraw(),Yi.show(X.answer?.cuts??[])})}function za(){let e=0,t=t=>{e=Math.max(0,t),J(`drop`).hidden=e===0};addEventListener(`dragenter`,n=>{n.preventDefault(),t(e+1)}),addEventListener(`dragleave`,()=>t(e-1)),addEventListener(`dragover`,e=>e.preventDefault()),addEventListener(`drop`,e=>{e.preventDefault(),t(0),la([...e.dataTransfer?.files??[]])})}function Ba(e,t,n){e.append(...t.map(({name:e,about:t})=>{let r=new Option(e,e,e===n,e===n);return r.title=t,r}))}async function Va(){let e=Object.entries(zi).map(([e,{about:t}])=>{let n=Z(`button`),r=Z(`canvas`);return n.type=`button`,n.dataset.example=e,r.setAttribute(`aria-hidden`,`true`),n.append(r,Z(`b`,e),Z(`span`,t)),n.addEventListener(`click`,()=>ca(e)),{card:n,canvas:r,name:e}});J(`cards`).replaceChildren(...e.map(({card:e})=>e));let t=new Ri;for(let{canvas:n,name:r}of e){let{points:e,kinds:i}=await t.ask({task:`check`,name:r,program:zi[r].program});Ha(n,e,i)}t.cancel()}function Ha(e,t,n){let r=e.getContext(`2d`),i=devicePixelRatio,{clientWidth:o,clientHeight:s}=e;[e.width,e.height]=[o*i,s*i];let c=e=>t.filter((t,n)=>n%3===e),[l,u]=[c(0),c(1)],[d,f,p,m]=[Math.min(...l),Math.max(...l),Math.min(...u),Math.max(...u)],h=Math.min((o-8)/(f-d||1),(s-8)/(m-p||1));r.setTransform(i,0,0,i,o*i/2,s*i/2),r.strokeStyle=a(.1),r.lineWidth=1.5,r.beginPath(),l.forEach((e,t)=>{let i=[(e-(d+f)/2)*h,-(u[t]-(p+m)/2)*h];n[t]&1?r.lineTo(...i):r.moveTo(...i)}),r.stroke()}async function Ua(){let e=(await(await fetch(`files.json`)).json()).map(async(e,t)=>new File([await(await fetch(`files/${t}`)).blob()],e));await la(await Promise.all(e))}async function Wa(){Ia(),$();for(let[e,{about:t}]of Object.entries(zi))na.append(Object.assign(new Option(e,e),{title:t}));try{await Fi();let e=X.lists=await Qi.ask({task:`lists`});Ba(ea,e.machines,e.machine),Ba(ta,e.controllers,e.controller),Ba(ra,e.controls,e.control),J(`version`).textContent=`feedwright ${e.version}.`;let t=Na();await Ua(),t&&!Xi.value?await ca(t):Xi.value?await pa():await Va()}catch(e){ba(`The engine does not start: ${e.message}`)}}Object.assign(globalThis,{feedwright:{view:Y}}),Wa();