# Follow the reference cases with DifferentialEquations.jl. An example as text: it was not run here.
#
#     julia with_julia.jl cases/cases.csv mine.csv && symosc score cases mine.csv
#
# Needs the package OrdinaryDiffEq. A mode of motion (a domain, or a stick) is integrated up to the
# first zero of its two end functions; the forces at the belt decide what happens there.
using OrdinaryDiffEq

const TOLERANCE = 1e-13

number(text) = occursin('/', text) ? Float64(parse(BigFloat, split(text, '/')[1]) / parse(BigFloat, split(text, '/')[2])) :
                                     parse(Float64, text)

"The acceleration that a domain gives."
function force(p, domain, t, x, v)
    friction = (p.mu1 + p.mu2, p.mu2 - p.mu1, -p.mu1 - p.mu2)[domain]
    (p.A0 + friction * p.FN + p.B0 * cos(p.Omega * t) - p.k * x - p.c * v) / p.m
end

"Integrate up to the first of two functions that falls through 0; return t, state and its number, 0 at the end."
function advance(p, rates!, ends, t, u)
    which = Ref(0)
    condition(out, u, t, integrator) = (out[1] = ends[1](u, t); out[2] = ends[2](u, t))
    affect!(integrator, i) = nothing
    falls!(integrator, i) = (which[] = i; terminate!(integrator))
    callback = VectorContinuousCallback(condition, affect!, falls!, 2; save_positions = (false, false))
    problem = ODEProblem(rates!, u, (t, p.t_end))
    found = solve(problem, Vern9(); reltol = TOLERANCE, abstol = TOLERANCE, callback, dtmax = 0.05 * 2pi / p.Omega,
                  save_everystep = false)
    found.t[end], found.u[end], which[]
end

"The events of a case: (t, x, kind, belt)."
function follow(p)
    events = Tuple{Float64,Float64,String,Int}[]
    t, x, v = p.t0, p.x0, p.v0
    speeds = (p.v1, p.v2)
    belt, domain = something(findfirst(==(v), speeds), 0), 1 + count(<(v), speeds)
    while t < p.t_end
        if belt > 0
            v = speeds[belt]
            below, above = force(p, belt, t, x, v), force(p, belt + 1, t, x, v)
            if below > 0 > above
                t > p.t0 && push!(events, (t, x, "stick", belt))
                ends = ((u, t) -> force(p, belt, t, u[1], v), (u, t) -> -force(p, belt + 1, t, u[1], v))
                t, u, which = advance(p, (du, u, _, t) -> (du[1] = v), ends, t, [x])
                which == 0 && return events
                x, domain = u[1], belt + which - 1
                push!(events, (t, x, "slip", belt))
            else
                before, domain = domain, belt + (above >= 0)
                t > p.t0 && before != domain && push!(events, (t, x, "cross", belt))
            end
        end
        # the distances from the belts, as they are inside the domain
        ends = ((u, t) -> domain == 1 ? p.v1 - u[2] : u[2] - p.v1, (u, t) -> domain == 3 ? u[2] - p.v2 : p.v2 - u[2])
        t, u, belt = advance(p, (du, u, _, t) -> (du[1] = u[2]; du[2] = force(p, domain, t, u[1], u[2])), ends, t, [x, v])
        belt == 0 && return events
        x = u[1]
    end
    events
end

function main(table, results)
    lines = split.(readlines(table), ',')
    open(results, "w") do out
        println(out, "case,t,x,kind,boundary,seconds")
        for cells in lines[2:end]
            row = Dict(zip(lines[1], cells))
            row["periods"] == "0" || continue
            names = (:m, :c, :k, :A0, :B0, :Omega, :v1, :v2, :mu1, :mu2, :FN, :t0, :x0, :v0, :t_end)
            p = NamedTuple{names}(Tuple(number(row[String(name)]) for name in names))
            seconds = @elapsed events = follow(p)
            for (t, x, kind, belt) in events
                println(out, join((row["name"], t, x, kind, belt, ""), ','))
            end
            println(out, join((row["name"], p.t_end, "", "end", "", seconds), ','))
        end
    end
end

main(ARGS...)
